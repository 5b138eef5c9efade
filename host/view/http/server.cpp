// claray-http.so: what make_http_server loads.
#include "host/view/http/http.hpp"
#include "host/view/http/limited_server.hpp"
#include "host/view/http/request_rules.hpp"

namespace claray::view {
namespace {

class Sink final : public HttpSink {
public:
    explicit Sink(httplib::DataSink& sink) : sink_(sink) {}
    [[nodiscard]] bool is_writable() override { return sink_.is_writable(); }
    [[nodiscard]] bool write(const std::string& bytes) override { return sink_.write(bytes.data(), bytes.size()); }

private:
    httplib::DataSink& sink_;
};

void give(HttpAnswer answer, httplib::Response& response) {
    response.status = answer.status;
    for (const auto& [name, value] : answer.headers) response.set_header(name, value);
    if (answer.stream) {
        response.set_content_provider(answer.type,
                                      [stream = std::move(answer.stream)](std::size_t, httplib::DataSink& sink) {
                                          Sink to(sink);
                                          return stream(to);
                                      });
    } else if (answer.content && !answer.content->empty()) {
        const std::size_t size = answer.content->size();
        response.set_content_provider(
            size, answer.type,
            [content = std::move(answer.content)](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                return sink.write(content->data() + offset, length);
            });
    }
}

httplib::Server::Handler handler_of(HttpHandler handler) {
    return [handler = std::move(handler)](const httplib::Request& request, httplib::Response& response) {
        give(handler({request.body, {request.params.begin(), request.params.end()}}), response);
    };
}

class Server final : public HttpServer {
public:
    explicit Server(const HttpAccess& access) : host_(access.host), server_(access) {}

    void get(const std::string& path, HttpHandler handler) override {
        server_.Get(path, handler_of(std::move(handler)));
    }
    void post(const std::string& path, HttpHandler handler) override {
        server_.Post(path, handler_of(std::move(handler)));
    }
    [[nodiscard]] std::string url_host() const override { return view::url_host(host_); }
    [[nodiscard]] int bind(int port) override {
        if (port == 0) return server_.bind_to_any_port(host_);
        return server_.bind_to_port(host_, port) ? port : -1;
    }
    void listen() override { server_.listen_after_bind(); }
    [[nodiscard]] bool is_running() const override { return server_.is_running(); }
    void stop() override { server_.stop(); }

private:
    std::string host_;
    LimitedServer server_;
};

}  // namespace
}  // namespace claray::view

extern "C" [[gnu::visibility("default")]] claray::view::HttpServer* claray_http_server(
    const claray::view::HttpAccess& access) {
    return new claray::view::Server(access);
}
