// The web page of the view, as clients ask for it.
#include "host/view/web/web.hpp"

#include <gtest/gtest.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <future>
#include <nlohmann/json.hpp>
#include <thread>

#include "host/compute/memory.hpp"
#include "host/view/http/request_rules.hpp"
#include "host/view/web/page.hpp"
#include "host/view/web/uploads.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

using namespace view;

Scene one_sphere() {
    Scene scene;
    scene.materials.resize(1);
    scene.meshes = {sphere(2)};
    scene.lights = {point_light({0, 4, 3}, glm::vec3(30))};
    scene.camera = Camera{{0, 1, 8}, {0, 0, 0}, {0, 1, 0}, 45.f};
    return scene;
}

const ViewConfig web_config{.render = {.width = 24, .height = 16, .spp = 4, .max_depth = 4}, .picture = {}};
const std::string part = "--frame\r\nContent-Type: image/jpeg\r\n\r\n";

int port_of(const std::string& url) { return std::stoi(url.substr(url.rfind(':') + 1)); }
/// Of "http://host:port/TOKEN/".
std::string token_of(const std::string& url) {
    const std::size_t end = url.rfind('/'), begin = url.rfind('/', end - 1) + 1;
    return url.substr(begin, end - begin);
}
int status_of(const httplib::Result& result) { return result ? result->status : 0; }

/// A connection that sends what it likes.
class RawClient {
public:
    explicit RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET, address.sin_port = htons(std::uint16_t(port));
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
        const timeval patience{3600, 0};  // for a server that never answers
        ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
        ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    }
    ~RawClient() { ::close(socket_); }
    RawClient(const RawClient&) = delete;
    RawClient& operator=(const RawClient&) = delete;

    /// Returns false as soon as the server does not take more.
    bool send(const std::string& text) {
        std::size_t sent = 0;
        while (connected_ && sent < text.size()) {
            const ssize_t count = ::send(socket_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
            if (count <= 0) return false;
            sent += std::size_t(count);
        }
        return connected_;
    }
    /// Returns what arrives until `words` have arrived or the connection ends.
    std::string receive(const std::string& words) {
        std::string text;
        char bytes[4096];
        while (text.find(words) == std::string::npos) {
            const ssize_t count = ::recv(socket_, bytes, sizeof bytes, 0);
            if (count <= 0) break;
            text.append(bytes, std::size_t(count));
        }
        return text;
    }
    std::string receive_all() { return receive(std::string(1, '\0') + "never"); }

private:
    int socket_ = -1;
    bool connected_ = false;
};

/// A view with all its samples that is served until the end of the test.
class ViewWeb : public testing::Test {
protected:
    void SetUp() override {
        std::promise<std::string> ready;
        WebConfig web{.port = 0, .goes_on = [this] { return !ends_; }};
        web.open = [this](const std::filesystem::path& file) {
            opened_ = file, opened_bytes_ = std::filesystem::file_size(file);
            if (file.filename() == "bad.obj")
                throw Error(ErrorKind::user, file.string() + " is no scene", "convert it");
            Scene scene = one_sphere();
            scene.materials.resize(2);
            return View(device(), scene, web_config);
        };
        web.ready = [&](const std::string& url) { ready.set_value(url); };
        served_ = std::async(std::launch::async, [this, web] { serve(view_, web); });
        const std::string url = ready.get_future().get();
        port_ = port_of(url);
        client_ = std::make_unique<httplib::Client>("127.0.0.1", port_);
        client_->set_read_timeout(std::chrono::hours(1));
        wait_for("24x16, 4 samples");
    }
    void TearDown() override { ends_ = true, served_.get(); }

    void wait_for(const std::string& words) {
        while (client_->Get("/status")->body.find(words) == std::string::npos) std::this_thread::yield();
    }
    int post(const std::string& line) { return status_of(client_->Post("/command", line, "text/plain")); }
    std::string ask(const std::string& path, const std::string& headers = {}) const {
        return "GET " + path + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n";
    }

    View view_{device(), one_sphere(), web_config};
    std::atomic<bool> ends_ = false;
    std::future<void> served_;
    int port_ = 0;
    std::unique_ptr<httplib::Client> client_;
    std::filesystem::path opened_;  // as the server asked for it
    std::uintmax_t opened_bytes_ = 0;
};

TEST_F(ViewWeb, ServesThePage) {
    const auto start = client_->Get("/");
    ASSERT_EQ(status_of(start), 200);
    EXPECT_EQ(start->get_header_value("Content-Type"), "text/html");
    EXPECT_EQ(start->get_header_value("X-Frame-Options"), "DENY");
    EXPECT_EQ(start->get_header_value("Cross-Origin-Resource-Policy"), "same-origin");
    EXPECT_NE(start->get_header_value("Content-Security-Policy").find("default-src 'self'"), std::string::npos);
    for (const PageFile& file : page_files()) {
        EXPECT_EQ(file.text.find("://"), file.path == "icon.svg" || file.path == "curve.js"
                                             ? file.text.find("://www.w3.org/")
                                             : std::string::npos)
            << file.path << " names another host";
        if (file.path != "index.html") {
            EXPECT_EQ(client_->Get("/" + file.path)->body, file.text);
        }
    }
    EXPECT_EQ(client_->Get("/main.js")->get_header_value("Content-Type"), "text/javascript");
    EXPECT_EQ(client_->Get("/view.css")->get_header_value("Content-Type"), "text/css");
    EXPECT_EQ(status_of(client_->Get("/", {{"Host", "evil.example"}})), 403);
    EXPECT_EQ(status_of(client_->Get("/picture.png", {{"Sec-Fetch-Site", "cross-site"}})), 403);
    EXPECT_EQ(status_of(client_->Post("/command", {{"Origin", "http://evil.example"}}, "home", "text/plain")), 403);
    EXPECT_EQ(post("jump"), 400);
    EXPECT_EQ(post("save x.png"), 403);
    EXPECT_EQ(post("resize 10 8"), 200);
    wait_for("10x8, 4 samples");
    View other(device(), one_sphere(), web_config);
    EXPECT_TRUE(throws_error(ErrorKind::user, "cannot listen",
                             [&] { serve(other, {.port = port_, .goes_on = [] { return false; }}); }));
}

TEST_F(ViewWeb, DescribesTheScene) {
    const auto described = [&] { return nlohmann::json::parse(client_->Get("/scene")->body); };
    const nlohmann::json scene = described();
    EXPECT_EQ(scene["objects"].size(), 1u);
    EXPECT_EQ(scene["objects"][0]["triangles"], one_sphere().meshes[0].triangles.size());
    EXPECT_EQ(scene["materials"][0]["kind"], "lambert");
    EXPECT_NEAR(scene["materials"][0]["values"]["albedo"][1].get<double>(), 0.7, 1e-6);
    EXPECT_EQ(scene["lights"][0]["values"]["position"], nlohmann::json({0, 4, 3}));
    EXPECT_EQ(scene["effects"][0]["name"], "lambert");
    EXPECT_EQ(scene["shows"].back(), "error");
    EXPECT_EQ(scene["keys"]["ArrowLeft"], "orbit -5 0");
    EXPECT_FALSE(scene["curve"].empty());
    for (const nlohmann::json& row : scene["material_values"])
        EXPECT_TRUE(scene["materials"][0]["values"].contains(row["name"])) << row;
    EXPECT_EQ(post("edit 0"), 200);
    EXPECT_EQ(post("material albedo 0.25 0.5 0.75"), 200);
    while (described()["materials"][0]["values"]["albedo"] != nlohmann::json({0.25, 0.5, 0.75}))
        std::this_thread::yield();
    EXPECT_EQ(described()["undo"], 1);
}

TEST_F(ViewWeb, FramesTellTheirState) {
    const auto state = [&] { return nlohmann::json::parse(client_->Get("/frame")->get_header_value("View-State")); };
    EXPECT_EQ(state()["spp"], 4);
    EXPECT_EQ(state()["complete"], true);
    EXPECT_GT(state()["noise"], 0);
    EXPECT_EQ(state()["camera"]["position"], nlohmann::json({0, 1, 8}));
    EXPECT_EQ(state()["instance"], nullptr);
    EXPECT_EQ(post("object 0"), 200);
    while (state()["instance"] != 0) std::this_thread::yield();
    EXPECT_NEAR(state()["pivot"][0].get<double>(), 0, 1e-6);
    EXPECT_EQ(post("look 0 2 8 0 0 0"), 200);
    while (state()["camera"]["position"] != nlohmann::json({0, 2, 8})) std::this_thread::yield();
    EXPECT_EQ(post("edit 7"), 200);
    while (state()["failed"] != true) std::this_thread::yield();
    EXPECT_EQ(state()["told"], "edit: there is no material 7; the scene has 1; count from 0");
}

TEST_F(ViewWeb, OnePageSteers) {
    const auto steers = [&](const std::string& page) {
        return client_->Get("/frame?page=" + page)->get_header_value("View-Steers") == "1";
    };
    const auto posted = [&](const std::string& page) {
        return status_of(client_->Post("/command?page=" + page, "orbit 1 0", "text/plain"));
    };
    EXPECT_TRUE(steers("a"));
    EXPECT_FALSE(steers("b"));
    EXPECT_EQ(client_->Get("/frame?page=b")->get_header_value("View-Pages"), "2");
    EXPECT_EQ(posted("a"), 200);
    EXPECT_EQ(posted("b"), 409);
    EXPECT_EQ(post("orbit 1 0"), 200) << "programs have no page";
    EXPECT_EQ(status_of(client_->Post("/steer?page=b", "", "text/plain")), 200);
    EXPECT_TRUE(steers("b"));
    EXPECT_FALSE(steers("a"));
    EXPECT_EQ(posted("a"), 409);
    EXPECT_EQ(posted("b"), 200);
}

TEST_F(ViewWeb, FilesArriveInPieces) {
    const auto send = [&](const std::string& request, const std::string& body = {}) {
        return status_of(client_->Post(request, body, "application/octet-stream"));
    };
    EXPECT_EQ(send("/upload?name=a.obj&at=0", "v 0"), 400) << "no drop has begun";
    EXPECT_EQ(send("/drop"), 200);
    for (const char* name : {"", "../a.obj", "/etc/a.obj", "a/../../b", "a%0ab", "a%5Cb", "a/"})
        EXPECT_EQ(send("/upload?name=" + std::string(name) + "&at=0", "v"), 400) << name;
    const std::string piece(longest_piece, 'v');
    EXPECT_EQ(send("/upload?name=parts/a.obj&at=0", piece), 200);
    EXPECT_EQ(send("/upload?name=parts/a.obj&at=0", piece + "v"), 413);
    EXPECT_EQ(send("/upload?name=parts/a.obj&at=5", "end"), 400) << "a piece is missing";
    EXPECT_EQ(send("/upload?name=parts/a.obj&at=" + std::to_string(piece.size()), "end"), 200);
    EXPECT_EQ(send("/open?name=b.obj"), 400) << "it was not sent";
    EXPECT_EQ(send("/open?name=parts/a.obj"), 200);
    wait_for("opened parts/a.obj");
    EXPECT_EQ(opened_bytes_, piece.size() + 3);
    EXPECT_TRUE(std::filesystem::exists(opened_));
    EXPECT_EQ(nlohmann::json::parse(client_->Get("/scene")->body)["materials"].size(), 2u)
        << "the scene that was opened";
    EXPECT_EQ(send("/drop"), 200);
    EXPECT_TRUE(std::filesystem::exists(opened_)) << "it is shown, and may be read again";
    EXPECT_EQ(send("/upload?name=bad.obj&at=0", "bad"), 200);
    EXPECT_EQ(send("/open?name=bad.obj"), 200);
    wait_for("\nbad.obj is no scene; convert it");
    EXPECT_EQ(nlohmann::json::parse(client_->Get("/scene")->body)["materials"].size(), 2u) << "the scene before";
    ends_ = true, served_.get();
    EXPECT_FALSE(std::filesystem::exists(opened_));
    served_ = std::async(std::launch::deferred, [] {});
}

TEST_F(ViewWeb, TellsErrorsUntilACommandSucceeds) {
    EXPECT_EQ(post("pick 99 0"), 200);
    wait_for("4 samples per pixel\npixel 99 0 is outside");
    EXPECT_EQ(post("camera"), 200);
    wait_for("\n--camera 0,1,8");
    EXPECT_EQ(post("orbit 1 0"), 200) << "says nothing, and what was told stays";
    wait_for("4 samples per pixel\n--camera 0,1,8");
    EXPECT_EQ(post("resize 16384 16384"), 200);
    wait_for("4 samples per pixel\n16384x16384 pixels are too many");
    EXPECT_EQ(post("orbit 1 0"), 200);
    while (client_->Get("/status")->body != "24x16, 4 samples per pixel\n") std::this_thread::yield();
}

/// Browsers show a part when the headers of the next one arrive.
TEST_F(ViewWeb, AStreamShowsItsLastFrameAtOnce) {
    RawClient client(port_);
    ASSERT_TRUE(client.send(ask("/stream")));
    const std::string text = client.receive("\xff\xd9\r\n" + part);
    const std::size_t begin = text.find(part);
    ASSERT_NE(begin, std::string::npos);
    ASSERT_TRUE(text.ends_with("\xff\xd9\r\n" + part)) << "the complete view sends no other frame";
    const std::string jpeg =
        text.substr(begin + part.size(), text.size() - begin - 2 * part.size() - std::string("\r\n").size());
    EXPECT_EQ(jpeg, client_->Get("/frame")->body);
    EXPECT_EQ(post("orbit 20 0"), 200);
    EXPECT_TRUE(client.receive("\xff\xd9\r\n" + part).ends_with(part));
}

TEST_F(ViewWeb, FramesHaveNumbers) {
    const auto frame = client_->Get("/frame?after=0");
    ASSERT_EQ(status_of(frame), 200);
    EXPECT_TRUE(frame->body.starts_with("\xff\xd8"));
    const std::string number = frame->get_header_value("Frame-Number"), next = "/frame?after=" + number;
    EXPECT_EQ(status_of(client_->Get(next)), 204) << "nothing is new";
    EXPECT_EQ(status_of(client_->Get("/frame?after=x")), 200);
    EXPECT_EQ(status_of(client_->Get("/frame?after=" + number + "999")), 200) << "of a view that was started anew";
    EXPECT_EQ(post("orbit 20 0"), 200);
    httplib::Result later = client_->Get(next);
    while (status_of(later) == 204) later = client_->Get(next);
    EXPECT_NE(later->get_header_value("Frame-Number"), number);
    EXPECT_NE(later->body, frame->body);
}

TEST_F(ViewWeb, StreamsThatWereLeftKeepNoThread) {
    for (int i = 0; i < 200; ++i) {
        RawClient client(port_);
        ASSERT_TRUE(client.send(ask("/stream")));
        ASSERT_NE(client.receive("\xff\xd9\r\n").find("\xff\xd9\r\n"), std::string::npos) << i;
    }
    EXPECT_EQ(status_of(client_->Get("/")), 200);
}

TEST_F(ViewWeb, StreamsThatAreForgottenKeepFewThreads) {
    std::vector<std::unique_ptr<RawClient>> clients;
    for (int i = 0; i < 100; ++i) {
        clients.push_back(std::make_unique<RawClient>(port_));
        ASSERT_TRUE(clients.back()->send(ask("/stream")));
        ASSERT_NE(clients.back()->receive("\xff\xd9\r\n").find("\xff\xd9\r\n"), std::string::npos) << i;
    }
    EXPECT_EQ(status_of(client_->Get("/")), 200);
    EXPECT_EQ(clients.front()->receive("the connection ends").find("the"), std::string::npos);
}

/// More than the buffers of a connection hold.
TEST_F(ViewWeb, WhatIsTooLongIsNotReadToItsEnd) {
    const std::string post = "POST /command HTTP/1.1\r\nHost: localhost\r\n", megabyte(1 << 20, 'x');
    const auto takes_all = [&](const std::string& begin, const std::string& piece) {
        RawClient client(port_);
        bool goes_on = client.send(begin);
        for (int i = 0; i < 64 && goes_on; ++i) goes_on = client.send(piece);
        return goes_on;
    };
    std::string headers;
    while (headers.size() < megabyte.size()) headers += "Name: value\r\n";
    EXPECT_FALSE(takes_all("GET /", megabyte)) << "a line";
    EXPECT_FALSE(takes_all("GET / HTTP/1.1\r\nHost: localhost\r\nName: ", megabyte)) << "a header";
    EXPECT_FALSE(takes_all("GET / HTTP/1.1\r\nHost: localhost\r\n", headers)) << "many headers";
    EXPECT_FALSE(takes_all(post + "Content-Length: 100000000\r\n\r\n", megabyte)) << "a body";
    EXPECT_FALSE(takes_all(post + "Origin: null\r\nContent-Length: 100000000\r\n\r\n", megabyte)) << "another's body";
    EXPECT_FALSE(takes_all(post + "Transfer-Encoding: chunked\r\n\r\n", "100000\r\n" + megabyte + "\r\n")) << "chunks";
    EXPECT_EQ(status_of(client_->Get("/")), 200);
}

TEST_F(ViewWeb, ABodyThatIsRefusedIsNoRequest) {
    const std::string inner = "POST /command HTTP/1.1\r\nHost: localhost\r\nContent-Length: 4\r\n\r\nquit";
    for (const std::string method : {"GET /", "POST /command"}) {
        for (const std::string headers : {"Origin: http://evil.example\r\n", "Content-Encoding: gzip\r\n", ""}) {
            RawClient client(port_);
            const std::string length = std::to_string(inner.size() + (headers.empty() ? 8000 : 0));
            ASSERT_TRUE(client.send(method + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "Expect: 100-continue\r\n" +
                                    "Content-Length: " + length + "\r\n\r\n" + inner));
            const std::string answer = client.receive_all();
            EXPECT_TRUE(answer.starts_with("HTTP/1.1 4")) << answer;
            EXPECT_EQ(answer.find("HTTP/1.1", 1), std::string::npos) << answer;
        }
    }
    EXPECT_EQ(status_of(client_->Get("/")), 200);
}

TEST_F(ViewWeb, PicturesHaveNoRanges) {
    const auto picture = client_->Get("/picture.png");
    ASSERT_EQ(status_of(picture), 200);
    EXPECT_TRUE(picture->body.starts_with("\x89PNG"));
    std::string ranges = "bytes=0-";
    while (ranges.size() < 8000) ranges += ",0-";
    for (const std::string& range : {ranges, std::string("bytes=3-9")}) {
        const auto part_of = client_->Get("/picture.png", {{"Range", range}});
        EXPECT_EQ(status_of(part_of), 200);
        EXPECT_EQ(part_of->body, picture->body);
    }
}

TEST(ViewUploads, OneDropHasALimit) {
    Uploads uploads(10);
    uploads.begin();
    uploads.add("a.obj", 0, "12345");
    uploads.add("a.obj", 5, "67");
    const Folder first = uploads.folder_with("a.obj");
    EXPECT_EQ(read_file(*first / "a.obj"), "1234567");
    EXPECT_TRUE(throws_error(ErrorKind::user, "in one drop", [&] { uploads.add("b.bin", 0, "1234"); }));
    EXPECT_TRUE(throws_error(ErrorKind::user, "it was not sent", [&] { (void)uploads.folder_with("b.bin"); }));
    uploads.begin();
    uploads.add("b.bin", 0, "1234567890");
    EXPECT_TRUE(std::filesystem::exists(*first / "a.obj")) << "a folder lives as long as its users";
}

TEST(ViewWebServer, ALostDeviceEndsIt) {
    View view(device(), one_sphere(), web_config);
    WebConfig web{.port = 0, .goes_on = [] { return true; }};
    web.ready = [&](const std::string&) { fail_command(device(), 2); };
    EXPECT_TRUE(throws_error(ErrorKind::device, "cannot run the kernel", [&] { serve(view, web); }));
    fail_command(device(), 0);
}

TEST(ViewWebServer, OtherComputersNeedAToken) {
    View view(device(), one_sphere(), web_config);
    WebConfig web{.host = "0.0.0.0", .port = 0, .goes_on = [] { return true; }};
    web.ready = [&](const std::string& url) {
        const std::string token = token_of(url);
        EXPECT_EQ(token.size(), 32u);
        httplib::Client client("127.0.0.1", port_of(url));
        for (const char* path : {"/", "/main.js", "/frame", "/scene", "/picture.png", "/0/"})
            EXPECT_EQ(status_of(client.Get(path)), 401) << path;
        EXPECT_EQ(status_of(client.Post("/command", "quit", "text/plain")), 401);
        const auto page = client.Get("/" + token + "/");
        ASSERT_EQ(status_of(page), 200);
        EXPECT_EQ(page->get_header_value("X-Frame-Options"), "DENY");
        EXPECT_EQ(status_of(client.Get("/" + token + "/main.js")), 200);
        EXPECT_EQ(status_of(client.Get("/status", {{"Authorization", "Bearer " + token}})), 200);
        EXPECT_EQ(status_of(client.Post("/" + token + "/command", "quit", "text/plain")), 200);
    };
    serve(view, web);
}

TEST(ViewWebServer, FramesOfOtherSitesNeedAToken) {
    View view(device(), one_sphere(), web_config);
    WebConfig web{.port = 0, .framed = true, .goes_on = [] { return true; }};
    web.ready = [&](const std::string& url) {
        const std::string token = token_of(url);
        EXPECT_EQ(token.size(), 32u);
        httplib::Client client("127.0.0.1", port_of(url));
        const httplib::Headers frame = {
            {"Sec-Fetch-Site", "cross-site"}, {"Sec-Fetch-Mode", "navigate"}, {"Sec-Fetch-Dest", "iframe"}};
        EXPECT_EQ(status_of(client.Get("/", frame)), 401);
        const auto page = client.Get("/" + token + "/", frame);
        ASSERT_EQ(status_of(page), 200);
        EXPECT_FALSE(page->has_header("X-Frame-Options"));
        EXPECT_EQ(page->get_header_value("Content-Security-Policy").find("frame-ancestors"), std::string::npos);
        EXPECT_EQ(status_of(client.Get("/" + token + "/picture.png", {{"Sec-Fetch-Site", "cross-site"}})), 403);
        EXPECT_EQ(status_of(client.Post("/" + token + "/command", "quit", "text/plain")), 200);
    };
    serve(view, web);
}

TEST(ViewWebServer, QuitEndsIt) {
    View view(device(), one_sphere(), web_config);
    WebConfig web{.port = 0, .goes_on = [] { return true; }};
    web.ready = [&](const std::string& url) {
        httplib::Client client("127.0.0.1", port_of(url));
        EXPECT_EQ(status_of(client.Post("/command", "quit", "text/plain")), 200);
    };
    serve(view, web);
    EXPECT_TRUE(view.ended());
}

}  // namespace
}  // namespace claray::test
