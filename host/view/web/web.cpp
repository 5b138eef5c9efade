#include "host/view/web/web.hpp"

#include <atomic>
#include <charconv>
#include <chrono>
#include <thread>

#include "host/base/format.hpp"
#include "host/io/image/stb_image_write.hpp"
#include "host/view/input.hpp"
#include "host/view/web/exchange.hpp"
#include "host/view/web/limited_server.hpp"
#include "host/view/web/page.hpp"
#include "host/view/web/request_rules.hpp"

namespace claray::view {
namespace {

constexpr int jpeg_quality = 90;

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

void send(httplib::Response& response, const Bytes& bytes, const char* type) {
    response.set_content_provider(bytes->size(), type,
                                  [bytes](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                                      return sink.write(bytes->data() + offset, length);
                                  });
}

/// The page asks for the frame after the last that it has; no answer has content if none comes soon.
void answer_frame(Exchange& exchange, const httplib::Request& request, httplib::Response& response) {
    const std::string after = request.get_param_value("after");
    std::uint64_t seen = 0;
    (void)std::from_chars(after.data(), after.data() + after.size(), seen);
    const Bytes jpeg = exchange.next_frame(seen);
    response.set_header("Frame-Number", std::to_string(seen));
    if (!jpeg)
        response.status = 204;
    else
        send(response, jpeg, "image/jpeg");
}

/// A sequence of JPEG images, each of which replaces the one before (multipart/x-mixed-replace). Chromium shows an
/// image when the headers of the next one arrive, so that these follow it at once. They state no length, which is not
/// known.
void stream(Exchange& exchange, httplib::Response& response) {
    static const std::string begin = "--frame\r\nContent-Type: image/jpeg\r\n\r\n";
    const auto send = [&exchange, stream = exchange.open_stream(), seen = std::uint64_t(0)](
                          std::size_t, httplib::DataSink& sink) mutable {
        const bool first = seen == 0;
        const Bytes jpeg = exchange.next_frame(seen);
        if (!exchange.is_open(stream) || !sink.is_writable()) return false;
        if (!jpeg) return true;
        const std::string end = "\r\n" + begin;
        return (!first || sink.write(begin.data(), begin.size())) && sink.write(jpeg->data(), jpeg->size()) &&
               sink.write(end.data(), end.size());
    };
    response.set_content_provider("multipart/x-mixed-replace; boundary=frame", send);
}

void answer_with(httplib::Response& response, int status, const std::string& why) {
    response.status = status;
    response.set_content(why + "\n", "text/plain");
}

void answer_command(Exchange& exchange, const httplib::Request& request, httplib::Response& response) {
    try {
        ViewCommand command = parse_command(request.body);
        if (command.name == "save")
            return answer_with(response, 403, "save: the page cannot write files; use picture.png");
        if (!exchange.add(std::move(command)))
            answer_with(response, 503, "too many commands are waiting; wait a moment");
    } catch (const Error& error) {
        answer_with(response, 400, error.what());
    }
}

void answer_picture(Exchange& exchange, httplib::Response& response) {
    const Bytes png = exchange.picture();
    if (!png) return answer_with(response, 503, "the picture takes too long; ask again");
    send(response, png, "image/png");
}

void add_routes(httplib::Server& server, Exchange& exchange) {
    server.Get("/", [text = page()](const httplib::Request&, httplib::Response& response) {
        response.set_content(text, "text/html");
    });
    server.Get("/frame", [&](const httplib::Request& request, httplib::Response& response) {
        answer_frame(exchange, request, response);
    });
    server.Get("/stream", [&](const httplib::Request&, httplib::Response& response) { stream(exchange, response); });
    server.Get("/status", [&](const httplib::Request&, httplib::Response& response) {
        response.set_content(exchange.status(), "text/plain");
    });
    server.Get("/picture.png",
               [&](const httplib::Request&, httplib::Response& response) { answer_picture(exchange, response); });
    server.Post("/command", [&](const httplib::Request& request, httplib::Response& response) {
        answer_command(exchange, request, response);
    });
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
    exchange.publish(encode_jpeg(frame.width, frame.height, frame.pixels, jpeg_quality),
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
            exchange.give_picture(encode_png(frame.width, frame.height, 4, {frame.pixels.begin(), frame.pixels.end()}));
        publish(exchange, frame, told);
    }
}

/// The thread that accepts connections. It ends with this object.
class Listening {
public:
    Listening(httplib::Server& server, Exchange& exchange)
        : server_(server), exchange_(exchange), thread_([this] { server_.listen_after_bind(), ended_ = true; }) {}
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
    httplib::Server& server_;
    Exchange& exchange_;
    std::atomic<bool> ended_ = false;
    std::thread thread_;
};

int bound_port(httplib::Server& server, const WebConfig& config) {
    if (config.port == 0) return server.bind_to_any_port(config.host);
    return server.bind_to_port(config.host, config.port) ? config.port : -1;
}

}  // namespace

void serve(View& view, const WebConfig& config) {
    LimitedServer server(config.host);
    Exchange exchange;
    add_routes(server, exchange);
    const int port = bound_port(server, config);
    const std::string name = url_host(config.host);
    if (port < 0)
        throw Error(ErrorKind::user, "cannot listen at " + name + ":" + std::to_string(config.port),
                    "the port may be in use; choose another, or 0 for any");
    publish(exchange, view.frame(), {});
    const Listening listening(server, exchange);
    if (config.ready) config.ready("http://" + name + ":" + std::to_string(port) + "/");
    render_loop(view, exchange, config);
}

}  // namespace claray::view
