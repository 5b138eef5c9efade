#include "host/view/http/limited_server.hpp"

#include "host/view/http/connection.hpp"
#include "host/view/http/request_rules.hpp"

namespace claray::view {
namespace {

constexpr std::size_t most_connections = 64;  // each has a thread; a page that is open has two

/// The library's own options let two programs listen at one port (SO_REUSEPORT).
void reuse_address(socket_t socket) {
    const int yes = 1;
    (void)::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

}  // namespace

LimitedServer::LimitedServer(HttpAccess access) : access_(std::move(access)) {
    set_socket_options(reuse_address);
    set_tcp_nodelay(true);  // the last bytes of a frame do not wait
    set_keep_alive_max_count(1000);
    set_keep_alive_timeout(2);
    new_task_queue = [] { return new httplib::ThreadPool(most_connections); };
    const std::string policy = "default-src 'self'; img-src 'self' blob:; base-uri 'none'; form-action 'none'";
    httplib::Headers headers = {
        {"Accept-Ranges", "none"},
        {"Cache-Control", "no-store"},
        {"Content-Security-Policy", policy + (access_.framed ? "" : "; frame-ancestors 'none'")},
        {"Cross-Origin-Resource-Policy", "same-origin"},
        {"Referrer-Policy", "same-origin"},  // an address may have the token
        {"X-Content-Type-Options", "nosniff"}};
    if (!access_.framed) headers.emplace("X-Frame-Options", "DENY");
    set_default_headers(std::move(headers));
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
        const std::optional<Refusal> refusal = refusal_of(request, access_);
        if (!refusal) return HandlerResponse::Unhandled;
        response.status = refusal->status;
        response.set_content(refusal->why + "\n", "text/plain");
        return HandlerResponse::Handled;
    });
}

/// A connection goes on only after a request that was read to its end: what is left of a body would be the next
/// request.
bool LimitedServer::process_and_close_socket(socket_t socket) {
    Connection connection(socket, svr_sock_);
    bool ends = false;
    const std::chrono::seconds idle(keep_alive_timeout_sec_);
    for (std::size_t left = keep_alive_max_count_; left > 0 && !ends && connection.has_request(idle); --left) {
        bool refused = true;  // unless its headers can be read
        const auto prepare = [&](httplib::Request& request) {
            request.ranges.clear();
            take_token(request, access_.token);
            refused = refusal_of(request, access_).has_value();
            if (!refused) return connection.expect(body_of(request));
            request.headers.erase("Expect");  // no body is asked for
            request.headers.erase("Connection");
            request.set_header("Connection", "close");
        };
        if (!process_request(connection, left == 1, ends, prepare)) ends = true;
        if (refused) connection.linger(), ends = true;
    }
    return !ends;
}

}  // namespace claray::view
