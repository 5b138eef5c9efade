#include "host/view/web/web.hpp"

#include <atomic>
#include <charconv>
#include <chrono>
#include <thread>

#include "host/base/format.hpp"
#include "host/io/image/write/encode.hpp"
#include "host/view/http/http.hpp"
#include "host/view/input.hpp"
#include "host/view/web/exchange.hpp"
#include "host/view/web/page.hpp"

namespace claray::view {
namespace {

constexpr unsigned jpeg_quality = 90;

void replace(std::string& text, const std::string& name, const std::string& by) {
    text.replace(text.find(name), name.size(), by);
}

std::string page() {
    std::string text = page_template, shows, keys;
    for (const CommandRow& row : view_commands())
        if (row.name == std::string("show"))
            for (const std::string& choice : choices_of(row)) shows += "<option>" + choice;
    for (const KeyRow& row : key_rows()) keys += printed("\"%s\": \"%s\", ", row.key, row.command);
    replace(text, "@shows@", shows), replace(text, "@keys@", keys);
    replace(text, "@help@", std::string(mouse_help) + ", " + key_help);
    replace(text, "@degrees@", printed("%g", degrees_per_pixel)), replace(text, "@zoom@", printed("%g", zoom_per_step));
    replace(text, "@click@", printed("%d", farthest_click));
    return text;
}

HttpAnswer text(int status, const std::string& line) {
    return {.status = status, .content = std::make_shared<const std::string>(line + "\n")};
}

/// The page asks for the frame after the last that it has; no answer has content if none comes soon.
HttpAnswer frame(Exchange& exchange, const HttpRequest& request) {
    std::uint64_t seen = 0;
    if (const auto after = request.parameters.find("after"); after != request.parameters.end())
        (void)std::from_chars(after->second.data(), after->second.data() + after->second.size(), seen);
    const Bytes jpeg = exchange.next_frame(seen);
    return {.status = jpeg ? 200 : 204,
            .type = "image/jpeg",
            .content = jpeg,
            .headers = {{"Frame-Number", std::to_string(seen)}}};
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

HttpAnswer command(Exchange& exchange, const HttpRequest& request) {
    try {
        ViewCommand command = parse_command(request.body);
        if (command.name == "save") return text(403, "save: the page cannot write files; use picture.png");
        if (!exchange.add(std::move(command))) return text(503, "too many commands are waiting; wait a moment");
        return {};
    } catch (const Error& error) {
        return text(400, error.what());
    }
}

HttpAnswer picture(Exchange& exchange) {
    const Bytes png = exchange.picture();
    return png ? HttpAnswer{.type = "image/png", .content = png} : text(503, "the picture takes too long; ask again");
}

void add_routes(HttpServer& server, Exchange& exchange) {
    server.get("/", [text = std::make_shared<const std::string>(page())](const HttpRequest&) {
        return HttpAnswer{.type = "text/html", .content = text};
    });
    server.get("/frame", [&](const HttpRequest& request) { return frame(exchange, request); });
    server.get("/stream", [&](const HttpRequest&) { return stream(exchange); });
    server.get("/status", [&](const HttpRequest&) {
        return HttpAnswer{.content = std::make_shared<const std::string>(exchange.status())};
    });
    server.get("/picture.png", [&](const HttpRequest&) { return picture(exchange); });
    server.post("/command", [&](const HttpRequest& request) { return command(exchange, request); });
}

/// The last line that a command told. An error is forgotten when a command succeeds.
class Told {
public:
    void take(const Answer& answer) {
        if (!answer.line.empty() || last_.failed) last_ = answer;
    }
    [[nodiscard]] const std::string& line() const { return last_.line; }

private:
    Answer last_;
};

void publish(Exchange& exchange, const Frame& frame, const Told& told) {
    exchange.publish(encode_jpeg(frame.width, frame.height, 4, frame.pixels, jpeg_quality),
                     printed("%ux%u, %u samples per pixel", frame.width, frame.height, frame.spp) + "\n" + told.line());
}

/// Runs commands and renders; only this thread uses the view.
void render_loop(View& view, Exchange& exchange, const WebConfig& config) {
    const auto interrupted = [&] { return exchange.has_commands() || !config.goes_on(); };
    Told told;
    bool shown = false;
    std::uint64_t number = 0;
    while (!view.ended() && config.goes_on()) {
        for (const ViewCommand& command : exchange.take()) told.take(answer(view, command)), shown = false;
        if (shown && !exchange.wants_picture()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            continue;
        }
        const Frame& frame = view.next_frame(interrupted);
        shown = frame.complete;
        if (std::exchange(number, frame.number) == frame.number) continue;
        if (exchange.wants_picture())
            exchange.give_picture(encode_png(frame.width, frame.height, 4, frame.pixels));
        publish(exchange, frame, told);
    }
}

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
    const std::unique_ptr<HttpServer> server = make_http_server(config.host);
    Exchange exchange;
    add_routes(*server, exchange);
    const int port = server->bind(config.port);
    const std::string name = server->url_host();
    if (port < 0)
        throw Error(ErrorKind::user, "cannot listen at " + name + ":" + std::to_string(config.port),
                    "the port may be in use; choose another, or 0 for any");
    publish(exchange, view.frame(), {});
    const Listening listening(*server, exchange);
    if (config.ready) config.ready("http://" + name + ":" + std::to_string(port) + "/");
    render_loop(view, exchange, config);
}

}  // namespace claray::view
