#include "host/view/web/web.hpp"

#include <atomic>
#include <charconv>
#include <chrono>
#include <random>
#include <thread>

#include "host/base/format.hpp"
#include "host/io/image/write/encode.hpp"
#include "host/view/http/http.hpp"
#include "host/view/web/description.hpp"
#include "host/view/web/exchange.hpp"
#include "host/view/web/page.hpp"
#include "host/view/web/uploads.hpp"
#include "host/view/web/viewers.hpp"

namespace claray::view {
namespace {

constexpr unsigned jpeg_quality = 90;

constexpr std::size_t most_uploaded = std::size_t(1) << 30;  // bytes of one drop

constexpr const char* open_command = "open";  // no command of users

/// What requests share.
struct Site {
    Exchange exchange;
    Viewers viewers;
    Uploads uploads{most_uploaded};
    std::atomic<unsigned> opened = 0;  // scenes after the first
};

bool is_this_computer(const std::string& host) {
    return host.starts_with("127.") || host == "localhost" || host == "::1";
}

/// 128 random bits, which nobody guesses.
std::string new_token() {
    std::random_device random;
    std::string token;
    for (int i = 0; i < 4; ++i) token += printed("%08x", random());
    return token;
}

HttpAnswer text(int status, const std::string& line) {
    return {.status = status, .content = std::make_shared<const std::string>(line + "\n")};
}

std::string parameter(const HttpRequest& request, const std::string& name) {
    const auto found = request.parameters.find(name);
    return found == request.parameters.end() ? "" : found->second;
}

std::uint64_t number(const std::string& text) {
    std::uint64_t value = 0;
    (void)std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

/// The page asks for the frame after the last that it has; no answer has content if none comes soon.
HttpAnswer frame(Site& site, const HttpRequest& request) {
    const std::string page = parameter(request, "page");
    std::uint64_t seen = number(parameter(request, "after"));
    const std::size_t viewers = site.viewers.saw(page);
    const Bytes jpeg = site.exchange.next_frame(seen);
    return {.status = jpeg ? 200 : 204,
            .type = "image/jpeg",
            .content = jpeg,
            .headers = {{"Frame-Number", std::to_string(seen)},
                        {"View-State", site.exchange.state()},
                        {"View-Opened", std::to_string(site.opened)},
                        {"View-Steers", site.viewers.steers(page) ? "1" : "0"},
                        {"View-Pages", std::to_string(viewers)}}};
}

/// A sequence of JPEG images, each of which replaces the one before (multipart/x-mixed-replace). Chromium shows an
/// image when the headers of the next one arrive, so that these follow it at once. They state no length, which is not
/// known.
HttpAnswer stream(Exchange& exchange) {
    static const std::string begin = "--frame\r\nContent-Type: image/jpeg\r\n\r\n";
    const auto send = [&exchange, stream = exchange.open_stream(), seen = std::uint64_t(0)](HttpSink& sink) mutable {
        const bool first = seen == 0;
        const Bytes jpeg = exchange.next_frame(seen);
        if (!exchange.is_open(stream) || !sink.is_writable()) return false;
        if (!jpeg) return true;
        return (!first || sink.write(begin)) && sink.write(*jpeg) && sink.write("\r\n" + begin);
    };
    return {.type = "multipart/x-mixed-replace; boundary=frame", .stream = send};
}

/// Answers a request that changes something; false if another page steers.
template <class Act>
HttpAnswer steered(Site& site, const HttpRequest& request, const Act& act) {
    if (!site.viewers.may_steer(parameter(request, "page")))
        return text(409, "another page steers; take the control first");
    try {
        return act();
    } catch (const Error& error) {
        return text(400, error.what());
    }
}

HttpAnswer add(Site& site, ViewCommand command) {
    if (!site.exchange.add(std::move(command))) return text(503, "too many commands are waiting; wait a moment");
    return {};
}

HttpAnswer command(Site& site, const HttpRequest& request) {
    return steered(site, request, [&] {
        ViewCommand command = parse_command(request.body);
        if (command.name == "save") return text(403, "save: the page cannot write files; use picture.png");
        return add(site, std::move(command));
    });
}

HttpAnswer made(Site& site, Made what, const char* type) {
    const Bytes bytes = site.exchange.ask(what);
    return bytes ? HttpAnswer{.type = type, .content = bytes} : text(503, "it takes too long; ask again");
}

void add_page(HttpServer& server) {
    for (const PageFile& file : page_files()) {
        const std::string end = file.path.substr(file.path.rfind('.') + 1);
        const char* const type = end == "html"  ? "text/html"
                                 : end == "css" ? "text/css"
                                 : end == "svg" ? "image/svg+xml"
                                                : "text/javascript";
        const HttpAnswer answer{.type = type, .content = std::make_shared<const std::string>(file.text)};
        server.get(end == "html" ? "/" : "/" + file.path, [answer](const HttpRequest&) { return answer; });
    }
}

void add_uploads(HttpServer& server, Site& site, const WebConfig& config) {
    if (!config.open) return;
    server.post("/drop", [&](const HttpRequest& request) {
        return steered(site, request, [&] { return site.uploads.begin(), HttpAnswer(); });
    });
    server.post("/upload", [&](const HttpRequest& request) {
        return steered(site, request, [&] {
            site.uploads.add(parameter(request, "name"), number(parameter(request, "at")), request.body);
            return HttpAnswer();
        });
    });
    server.post("/open", [&](const HttpRequest& request) {
        return steered(site, request, [&] {
            const std::string name = parameter(request, "name");
            (void)site.uploads.folder_with(name);
            return add(site, {.name = open_command, .word = name, .numbers = {}});
        });
    });
}

void add_routes(HttpServer& server, Site& site, const WebConfig& config) {
    add_page(server);
    add_uploads(server, site, config);
    server.get("/frame", [&](const HttpRequest& request) { return frame(site, request); });
    server.get("/stream", [&](const HttpRequest&) { return stream(site.exchange); });
    server.get("/status", [&](const HttpRequest&) {
        return HttpAnswer{.content = std::make_shared<const std::string>(site.exchange.status())};
    });
    server.get("/scene", [&](const HttpRequest&) { return made(site, Made::scene, "application/json"); });
    if (config.command_line)
        server.get("/command-line", [&](const HttpRequest&) { return made(site, Made::command_line, "text/plain"); });
    if (config.job)
        server.get("/job.json", [&](const HttpRequest&) { return made(site, Made::job, "application/json"); });
    server.get("/picture.png", [&](const HttpRequest&) { return made(site, Made::picture, "image/png"); });
    server.post("/command", [&](const HttpRequest& request) { return command(site, request); });
    server.post("/steer", [&](const HttpRequest& request) {
        return site.viewers.take(parameter(request, "page")), HttpAnswer();
    });
}

/// The last line that a command told. An error is forgotten when a command succeeds.
class Told {
public:
    void take(const Answer& answer) {
        if (!answer.line.empty() || last_.failed) last_ = answer;
    }
    [[nodiscard]] const Answer& last() const { return last_; }

private:
    Answer last_;
};

void publish(Exchange& exchange, const View& view, const Frame& frame, const Told& told) {
    exchange.publish(
        encode_jpeg(frame.width, frame.height, 4, frame.pixels, jpeg_quality),
        printed("%ux%u, %u samples per pixel", frame.width, frame.height, frame.spp) + "\n" + told.last().line,
        describe_frame(view, frame, told.last()));
}

/// Runs commands and renders; only this thread uses the view.
class RenderLoop {
public:
    RenderLoop(View& view, Site& site, const WebConfig& config) : view_(view), site_(site), config_(config) {}

    void run() {
        const auto interrupted = [&] { return exchange_.has_commands() || !config_.goes_on(); };
        bool shown = false, answers = false;
        while (!view_.ended() && config_.goes_on()) {
            for (const ViewCommand& command : exchange_.take())
                told_.take(answer_of(command)), shown = false, answers = true;
            give_texts();
            if (shown && !exchange_.wants(Made::picture) && !view_.costs().is_ready()) {
                exchange_.wait_for_clients();
                continue;
            }
            const Frame& frame = view_.next_frame(interrupted);
            shown = frame.complete;
            if (std::exchange(number_, frame.number) == frame.number) continue;
            if (exchange_.wants(Made::picture))
                exchange_.give(Made::picture, encode_png(frame.width, frame.height, 4, frame.pixels));
            publish(exchange_, view_, frame, told_);
            if (std::exchange(answers, false)) exchange_.wait_for_display();
        }
    }

private:
    void give_texts() {
        if (exchange_.wants(Made::scene)) exchange_.give(Made::scene, describe(view_, bool(config_.job)));
        for (const auto& [made, text] :
             {std::pair(Made::command_line, &config_.command_line), std::pair(Made::job, &config_.job)})
            if (exchange_.wants(made)) exchange_.give(made, (*text)(view_));
    }

    /// Pages learn before that loading takes long.
    Answer answer_of(const ViewCommand& command) {
        if (command.name != open_command) return answer(view_, command);
        exchange_.set_state(describe_frame(view_, view_.frame(), {"loads " + command.word, false}));
        return open(command.word);
    }

    /// After an error the scene is as before. Users do not know the folder of a file that they dropped.
    Answer open(const std::string& name) {
        Folder folder;
        try {
            folder = site_.uploads.folder_with(name);
            view_ = config_.open(*folder / name);
        } catch (const Error& error) {
            if (error.kind() == ErrorKind::device) throw;
            const std::string line = error.what(), before = folder ? folder->string() + "/" : "";
            const std::size_t at = before.empty() ? std::string::npos : line.find(before);
            return {at == std::string::npos ? line : line.substr(0, at) + line.substr(at + before.size()), true};
        }
        folder_ = std::move(folder), number_ = 0, ++site_.opened;
        return {"opened " + name, false};
    }

    View& view_;
    Site& site_;
    const WebConfig& config_;
    Exchange& exchange_ = site_.exchange;
    Folder folder_;  // of the scene that is shown, if it was dropped
    Told told_;
    std::uint64_t number_ = 0;  // of the last frame
};

/// The thread that accepts connections. It ends with this object.
class Listening {
public:
    Listening(HttpServer& server, Exchange& exchange)
        : server_(server), exchange_(exchange), thread_([this] { server_.listen(), ended_ = true; }) {}
    ~Listening() {
        exchange_.end();
        // A server that does not run yet would not stop.
        while (!server_.is_running() && !ended_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        server_.stop();
        thread_.join();
    }
    Listening(const Listening&) = delete;
    Listening& operator=(const Listening&) = delete;

private:
    HttpServer& server_;
    Exchange& exchange_;
    std::atomic<bool> ended_ = false;
    std::thread thread_;
};

}  // namespace

void serve(View& view, const WebConfig& config) {
    const std::string token = is_this_computer(config.host) && !config.framed ? "" : new_token();
    const std::unique_ptr<HttpServer> server = make_http_server({config.host, token, config.framed});
    Site site;
    add_routes(*server, site, config);
    const int port = server->bind(config.port);
    const std::string name = server->url_host();
    if (port < 0)
        throw Error(ErrorKind::user, "cannot listen at " + name + ":" + std::to_string(config.port),
                    "the port may be in use; choose another, or 0 for any");
    publish(site.exchange, view, view.frame(), {});
    const Listening listening(*server, site.exchange);
    if (config.ready)
        config.ready("http://" + name + ":" + std::to_string(port) + "/" + (token.empty() ? "" : token + "/"));
    RenderLoop(view, site, config).run();
}

}  // namespace claray::view
