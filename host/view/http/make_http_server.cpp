#include "host/base/process/plugin.hpp"
#include "host/view/http/http.hpp"

namespace claray::view {

std::unique_ptr<HttpServer> make_http_server(const HttpAccess& access) {
    auto* const make = plugin_function<HttpServer*(const HttpAccess&)>(
        "claray-http.so", "claray_http_server",
        "the web page cannot be served: ", "install claray with claray-http.so");
    return std::unique_ptr<HttpServer>(make(access));
}

}  // namespace claray::view
