// A server of HTTP. It stands in a library of its own, which only the web page loads: cpp-httplib brings OpenSSL and
// others.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

namespace claray::view {

using Bytes = std::shared_ptr<const std::string>;

struct HttpRequest {
    std::string body;
    std::map<std::string, std::string> parameters;  ///< of the URL
};

/// Where a stream is written to.
class HttpSink {
public:
    virtual ~HttpSink() = default;
    /// False as soon as the client has closed its side.
    [[nodiscard]] virtual bool is_writable() = 0;
    [[nodiscard]] virtual bool write(const std::string& bytes) = 0;
};

struct HttpAnswer {
    int status = 200;
    std::string type = "text/plain";
    Bytes content = {};  ///< null: none
    std::map<std::string, std::string> headers = {};
    /// Instead of content: writes the next part; false ends the answer.
    std::function<bool(HttpSink&)> stream = {};
};
using HttpHandler = std::function<HttpAnswer(const HttpRequest&)>;

/// Who may ask a server.
struct HttpAccess {
    std::string host;  ///< the address to listen at
    /// That every request must have: as the first folder of its path, or as a header Authorization. Empty: none.
    std::string token = {};
    bool framed = false;  ///< pages of other sites may show the page in a frame: those that know the token
};

/// Bounds what clients cost, and refuses requests of other sites: see `refusal_of` and LimitedServer.
class HttpServer {
public:
    virtual ~HttpServer() = default;
    /// Handlers are called from several threads.
    virtual void get(const std::string& path, HttpHandler handler) = 0;
    virtual void post(const std::string& path, HttpHandler handler) = 0;
    /// The host as URLs write it.
    [[nodiscard]] virtual std::string url_host() const = 0;
    /// Returns the port; 0 takes any that is free. Returns -1 if it cannot be had.
    [[nodiscard]] virtual int bind(int port) = 0;
    /// Serves until `stop`.
    virtual void listen() = 0;
    [[nodiscard]] virtual bool is_running() const = 0;
    virtual void stop() = 0;
};

/// Throws ErrorKind::user if this claray has no server.
[[nodiscard]] std::unique_ptr<HttpServer> make_http_server(const HttpAccess& access);

}  // namespace claray::view
