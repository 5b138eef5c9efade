#include "host/view/web.hpp"

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

#include "host/base/format.hpp"
#include "host/io/image/stb_image_write.hpp"
#include "host/view/input.hpp"
#include "host/view/page.hpp"

namespace claray::view {
namespace {

constexpr int jpeg_quality = 90;
constexpr std::size_t most_waiting = 256;     // commands
constexpr std::size_t most_connections = 64;  // each has a thread; a page that is open has two
constexpr auto longest_wait = std::chrono::milliseconds(500);
constexpr auto longest_picture = std::chrono::seconds(10);

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

/// Frames and commands on their way between the loop that renders and the threads that answer requests.
class Exchange {
public:
    void publish(std::string jpeg, const std::string& status) {
        const std::lock_guard lock(mutex_);
        jpeg_ = std::move(jpeg), status_ = status, ++number_;
        changed_.notify_all();
    }
    /// Waits for a frame after number `seen`, but not long. Returns its number.
    std::uint64_t wait_for(std::uint64_t seen, std::string& jpeg) {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, longest_wait, [&] { return number_ > seen || ended_; });
        jpeg = jpeg_;
        return number_;
    }
    /// Asks for what is seen as a PNG, and waits for it, but not long; empty if it does not come.
    std::string picture() {
        std::unique_lock lock(mutex_);
        picture_.reset(), wants_picture_ = true;
        changed_.wait_for(lock, longest_picture, [&] { return picture_ || ended_; });
        return picture_.value_or("");
    }
    [[nodiscard]] bool wants_picture() {
        const std::lock_guard lock(mutex_);
        return wants_picture_;
    }
    void give_picture(std::string png) {
        const std::lock_guard lock(mutex_);
        picture_ = std::move(png), wants_picture_ = false;
        changed_.notify_all();
    }
    [[nodiscard]] std::string status() {
        const std::lock_guard lock(mutex_);
        return status_;
    }
    /// Returns false if too many are waiting.
    bool add(ViewCommand command) {
        const std::lock_guard lock(mutex_);
        if (commands_.size() >= most_waiting) return false;
        commands_.push_back(std::move(command));
        return true;
    }
    std::deque<ViewCommand> take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(commands_, {});
    }
    void end() {
        const std::lock_guard lock(mutex_);
        ended_ = true;
        changed_.notify_all();
    }
    [[nodiscard]] bool ended() {
        const std::lock_guard lock(mutex_);
        return ended_;
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::string jpeg_, status_;
    std::uint64_t number_ = 0;
    std::deque<ViewCommand> commands_;
    std::optional<std::string> picture_;  // a PNG
    bool wants_picture_ = false, ended_ = false;
};

/// The host of a Host header, without the port.
std::string host_of(const std::string& header) {
    const std::size_t end = header.starts_with('[') ? header.find(']') + 1 : header.find(':');
    return header.substr(0, end);
}

bool is_this_host(const std::string& header, const WebConfig& config) {
    const std::string host = host_of(header);
    if (config.host == "127.0.0.1") return host == "127.0.0.1" || host == "localhost";
    return host != "" && (config.host == "0.0.0.0" || host == config.host);
}

/// A sequence of JPEG images, each of which replaces the one before (multipart/x-mixed-replace).
void stream(Exchange& exchange, httplib::Response& response) {
    response.set_chunked_content_provider(
        "multipart/x-mixed-replace; boundary=frame",
        [&exchange, seen = std::uint64_t(0)](std::size_t, httplib::DataSink& sink) mutable {
            std::string jpeg;
            const std::uint64_t number = exchange.wait_for(seen, jpeg);
            if (exchange.ended()) {
                sink.done();
                return true;
            }
            if (number == seen) return true;
            seen = number;
            const std::string part =
                "--frame\r\nContent-Type: image/jpeg\r\nContent-Length: " + std::to_string(jpeg.size()) + "\r\n\r\n" +
                jpeg + "\r\n";
            return sink.write(part.data(), part.size());
        });
}

void answer_command(Exchange& exchange, const httplib::Request& request, httplib::Response& response) {
    const auto refuse = [&](int status, const std::string& why) {
        response.status = status;
        response.set_content(why + "\n", "text/plain");
    };
    try {
        ViewCommand command = parse_command(request.body);
        if (command.name == "save") return refuse(403, "save: the page cannot write files; use picture.png");
        if (!exchange.add(std::move(command))) return refuse(503, "too many commands are waiting");
    } catch (const Error& error) {
        refuse(400, error.what());
    }
}

void add_routes(httplib::Server& server, Exchange& exchange, const WebConfig& config) {
    server.set_pre_routing_handler([&config](const httplib::Request& request, httplib::Response& response) {
        const std::string host = request.get_header_value("Host"), origin = request.get_header_value("Origin");
        const bool own_page = origin.empty() || origin == "http://" + host;
        if (is_this_host(host, config) && own_page) return httplib::Server::HandlerResponse::Unhandled;
        response.status = 403;
        response.set_content("the view is not served to other hosts; see claray view --host\n", "text/plain");
        return httplib::Server::HandlerResponse::Handled;
    });
    server.Get("/", [text = page()](const httplib::Request&, httplib::Response& response) {
        response.set_content(text, "text/html");
    });
    server.Get("/stream", [&](const httplib::Request&, httplib::Response& response) { stream(exchange, response); });
    server.Get("/status", [&](const httplib::Request&, httplib::Response& response) {
        response.set_content(exchange.status(), "text/plain");
    });
    server.Get("/picture.png", [&](const httplib::Request&, httplib::Response& response) {
        response.set_content(exchange.picture(), "image/png");
        if (response.body.empty()) response.status = 503;
    });
    server.Post("/command", [&](const httplib::Request& request, httplib::Response& response) {
        answer_command(exchange, request, response);
    });
}

/// The library's own options let two programs listen at one port (SO_REUSEPORT).
void reuse_address(socket_t socket) {
    const int yes = 1;
    (void)::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

/// Runs commands and renders; only this thread uses the view.
void render_loop(View& view, Exchange& exchange, const WebConfig& config) {
    std::string told;
    bool shown = false;
    while (!view.ended() && config.goes_on()) {
        for (const ViewCommand& command : exchange.take()) {
            if (const std::string line = answer(view, command); !line.empty()) told = line;
            shown = false;
        }
        if (shown && !exchange.wants_picture()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            continue;
        }
        const Frame& frame = view.next_frame();
        shown = frame.complete;
        if (exchange.wants_picture())
            exchange.give_picture(encode_png(frame.width, frame.height, 4, {frame.pixels.begin(), frame.pixels.end()}));
        exchange.publish(encode_jpeg(frame.width, frame.height, frame.pixels, jpeg_quality),
                         printed("%ux%u, %u samples per pixel", frame.width, frame.height, frame.spp) + "\n" + told);
    }
}

}  // namespace

void serve(View& view, const WebConfig& config) {
    httplib::Server server;
    server.set_socket_options(reuse_address);
    server.new_task_queue = [] { return new httplib::ThreadPool(most_connections); };
    Exchange exchange;
    server.set_keep_alive_max_count(1000);
    add_routes(server, exchange, config);
    const int port = config.port == 0 ? server.bind_to_any_port(config.host)
                                      : (server.bind_to_port(config.host, config.port) ? config.port : -1);
    if (port < 0)
        throw Error(ErrorKind::user, "cannot listen at " + config.host + ":" + std::to_string(config.port),
                    "the port may be in use; choose another, or 0 for any");
    std::atomic<bool> answered = false;
    std::thread answers([&] { server.listen_after_bind(), answered = true; });
    const auto stop = [&] {
        exchange.end();
        // A server that does not run yet would not stop.
        while (!server.is_running() && !answered) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        server.stop();
        answers.join();
    };
    try {
        if (config.ready) config.ready("http://" + config.host + ":" + std::to_string(port) + "/");
        render_loop(view, exchange, config);
    } catch (...) {
        stop();
        throw;
    }
    stop();
}

}  // namespace claray::view
