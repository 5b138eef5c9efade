// `claray view` as a web page: the browser that it opens, and the render that it saves.
#include <gtest/gtest.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "claray/io.hpp"
#include "host/base/process/environment.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

int free_port() {
    sockaddr_in address{};
    address.sin_family = AF_INET, address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    EXPECT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), size), 0);
    EXPECT_EQ(::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size), 0);
    ::close(socket);
    return ntohs(address.sin_port);
}

/// The farthest that red, green and blue of two PNGs are apart, which may have an alpha.
int difference(const std::filesystem::path& a, const std::filesystem::path& b) {
    const Texture one = load_image(a), other = load_image(b);
    if (one.width != other.width || one.height != other.height) return 256;
    int most = 0;
    for (std::size_t i = 0; i < std::size_t(one.width) * one.height; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            most = std::max(most,
                            std::abs(int(one.bytes[i * one.channels + k]) - int(other.bytes[i * other.channels + k])));
    return most;
}

/// Stands for the browser: writes the address that it shall show to a file.
class ViewProgramPage : public testing::Test {
protected:
    ViewProgramPage() {
        const auto browser = folder_.file("xdg-open", "#!/bin/sh\necho \"$1\" > '" + address().string() + "'\n");
        std::filesystem::permissions(browser, std::filesystem::perms::owner_all);
    }
    [[nodiscard]] std::filesystem::path address() const { return folder_ / "address"; }
    [[nodiscard]] Variables display() const {
        return {{"DISPLAY", ":0"}, {"PATH", folder_.path().string() + ":" + environment("PATH")}};
    }
    [[nodiscard]] int port_told() const {
        const std::string url = std::filesystem::exists(address()) ? read_file(address()) : "";
        return url.ends_with("/\n") ? std::stoi(url.substr(url.rfind(':') + 1)) : 0;
    }

    TemporaryFolder folder_;
};

TEST_F(ViewProgramPage, OpensABrowserAndSavesTheRender) {
    Process view({CLARAY_PROGRAM, "view", "cornell", "--port", "0", "--size", "32x18", "--spp", "2", "--max-depth", "7",
                  "--sky", "0.1,0.2,0.3"},
                 display());
    ASSERT_TRUE(view.brings_about([&] { return port_told() > 0; }));
    httplib::Client client("127.0.0.1", port_told());
    client.set_read_timeout(std::chrono::hours(1));
    ASSERT_TRUE(client.Post("/command", "stops 1.5", "text/plain"));
    const auto line = client.Get("/command-line");
    ASSERT_TRUE(line);
    EXPECT_TRUE(line->body.starts_with("claray render cornell --")) << line->body;
    EXPECT_NE(line->body.find(" --sky 0.1,0.2,0.3"), std::string::npos) << line->body;
    EXPECT_NE(line->body.find(" --exposure 1.5"), std::string::npos) << line->body;
    const auto saved = client.Get("/job.json");
    ASSERT_TRUE(saved);
    const nlohmann::json job = nlohmann::json::parse(saved->body);
    EXPECT_EQ(job["scene"], "cornell");
    EXPECT_EQ(job["size"], "32x18");
    EXPECT_EQ(job["max-depth"], 7);
    const auto file = folder_.file("job.json", saved->body);
    const ProcessResult rendered = run_process({CLARAY_PROGRAM, "render", file.string()});
    EXPECT_EQ(rendered.exit_code, 0) << rendered.errors;
    EXPECT_TRUE(std::filesystem::exists(folder_ / "view.png"));
    view.send(SIGINT);
    (void)view.wait();
}

/// The light of a file without light is a studio for the first camera, and the job keeps it.
TEST_F(ViewProgramPage, ItsJobRepeatsWhatIsShown) {
    const auto scene = folder_.file("ball.obj",
                                    "mtllib ball.mtl\nusemtl paint\nv -1 -1 0\nv 1 -1 0\nv 0 1 0.5\nv 0 0 -1\n"
                                    "f 1 2 3\nf 2 4 3\nf 4 1 3\n");
    (void)folder_.file("ball.mtl", "newmtl paint\nKd 0.6 0.5 0.4\n");
    Process view({CLARAY_PROGRAM, "view", scene.string(), "--port", "0", "--size", "32x18", "--spp", "4"}, display());
    ASSERT_TRUE(view.brings_about([&] { return port_told() > 0; }));
    httplib::Client client("127.0.0.1", port_told());
    client.set_read_timeout(std::chrono::hours(1));
    for (const char* line : {"object 0", "rotate 0 1 0 20", "edit 0", "material albedo 0.1 0.2 0.9", "orbit 25 10"})
        ASSERT_TRUE(client.Post("/command", line, "text/plain"));
    const auto complete = [&] {
        const auto frame = client.Get("/frame");
        const auto state = nlohmann::json::parse(frame ? frame->get_header_value("View-State") : "{}", nullptr, false);
        return state.value("complete", false) && state.value("revision", 0) == 4;
    };
    ASSERT_TRUE(view.brings_about(complete));
    const auto shown = client.Get("/picture.png"), saved = client.Get("/job.json");
    ASSERT_TRUE(shown && saved);
    const nlohmann::json job = nlohmann::json::parse(saved->body);
    EXPECT_EQ(job["set"].size(), 2u) << job;
    EXPECT_TRUE(job.contains("studio")) << job;
    const ProcessResult result = run_process({CLARAY_PROGRAM, "render", folder_.file("job.json", saved->body).string(),
                                              "-o", (folder_ / "again.png").string()});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(result.errors.find("studio"), std::string::npos) << "no other light is chosen: " << result.errors;
    EXPECT_LE(difference(folder_.file("shown.png", shown->body), folder_ / "again.png"), 1)
        << "its direction is rounded";
    view.send(SIGINT);
    (void)view.wait();
}

/// A browser would be opened before the first command is run.
TEST_F(ViewProgramPage, OpensNoBrowserIfToldSo) {
    const int port = free_port();
    Process view({CLARAY_PROGRAM, "view", "cornell", "--port", std::to_string(port), "--size", "8x8", "--spp", "1",
                  "--no-browser"},
                 display());
    httplib::Client client("127.0.0.1", port);
    ASSERT_TRUE(view.brings_about([&] { return bool(client.Post("/command", "quit", "text/plain")); }));
    EXPECT_EQ(view.wait().exit_code, 0);
    EXPECT_FALSE(std::filesystem::exists(address()));
}

}  // namespace
}  // namespace claray::test
