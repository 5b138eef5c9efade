#include "host/view/http/request_rules.hpp"

#include <httplib.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "host/view/http/http.hpp"

namespace claray::view {
namespace {

constexpr const char* digits = "0123456789";
const std::string bearer = "Bearer ";  // RFC 6750, section 2.1

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text;
}

/// The host of a Host header in lower case; empty unless the header is HOST or HOST:PORT (RFC 9110, section 7.2).
std::string host_of(const std::string& header) {
    const std::string text = lower(header);
    const std::size_t colon = text.find(':', text.starts_with('[') ? text.find(']') : 0);
    const std::string host = text.substr(0, colon), port = colon == std::string::npos ? "" : text.substr(colon + 1);
    const std::string letters = std::string("abcdefghijklmnopqrstuvwxyz.-_") + digits;
    const bool address = host.starts_with('[') && host.ends_with(']');
    const std::string name = address ? host.substr(1, host.size() - 2) : host;
    const bool plain = name.find_first_not_of(address ? letters + ":" : letters) == std::string::npos;
    return plain && port.find_first_not_of(digits) == std::string::npos ? host : "";
}

/// This computer has several names.
bool is_served(const std::string& host, const std::string& served) {
    static constexpr std::array own = {"127.0.0.1", "localhost", "[::1]"};
    const auto is_own = [](const std::string& name) { return std::find(own.begin(), own.end(), name) != own.end(); };
    const std::string name = url_host(served);
    if (host.empty()) return false;
    return name == "0.0.0.0" || name == "[::]" || host == name || (is_own(host) && is_own(name));
}

/// Browsers state where a request comes from (W3C Fetch Metadata). Links of other sites to the page are followed, and
/// frames of other sites show it if they may: no page can look into it.
bool is_of_another_site(const httplib::Request& request, bool framed) {
    const std::string site = request.get_header_value("Sec-Fetch-Site");
    const std::string place = request.get_header_value("Sec-Fetch-Dest");
    const bool opens_page = request.path == "/" && request.method == "GET" &&
                            request.get_header_value("Sec-Fetch-Mode") == "navigate" &&
                            (place == "document" || (framed && place == "iframe"));
    return !site.empty() && site != "same-origin" && site != "none" && !opens_page;
}

bool is_of_another_origin(const httplib::Request& request, const std::string& host) {
    return request.has_header("Origin") && lower(request.get_header_value("Origin")) != "http://" + lower(host);
}

/// The time does not depend on where the texts differ.
bool are_equal(const std::string& a, const std::string& b) {
    unsigned differences = a.size() == b.size() ? 0 : 1;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        differences |= unsigned(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
    return differences == 0;
}

bool has_token(const httplib::Request& request, const std::string& token) {
    return token.empty() || are_equal(request.get_header_value("Authorization"), bearer + token);
}

std::optional<Refusal> refusal_of_body(const httplib::Request& request) {
    if (request.has_header("Content-Encoding")) return Refusal{415, "a compressed body is not read"};
    if (request.has_header("Transfer-Encoding")) return Refusal{411, "a body without its length is not read"};
    const std::size_t lengths = request.get_header_value_count("Content-Length");
    if (lengths == 0 && request.method != "POST") return {};
    if (lengths != 1) return Refusal{411, "the length of the body must be stated once"};
    const std::string text = request.get_header_value("Content-Length");
    std::size_t length = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), length);
    if (text.empty() || end != text.data() + text.size() || error == std::errc::invalid_argument)
        return Refusal{400, "the length of the body is not a number"};
    if (request.method != "POST" && length > 0) return Refusal{400, "only POST has a body"};
    const std::size_t longest = request.path == "/upload" ? longest_piece : longest_body;
    if (error == std::errc::result_out_of_range || length > longest)
        return Refusal{413, "a body may have " + std::to_string(longest) + " bytes"};
    return {};
}

}  // namespace

std::string url_host(const std::string& host) {
    return host.find(':') == std::string::npos ? lower(host) : "[" + lower(host) + "]";
}

std::size_t body_of(const httplib::Request& request) {
    const std::string text = request.get_header_value("Content-Length");
    std::size_t length = 0;
    (void)std::from_chars(text.data(), text.data() + text.size(), length);
    return length;
}

void take_token(httplib::Request& request, const std::string& token) {
    const std::size_t end = request.path.find('/', 1);
    if (token.empty() || end == std::string::npos || !are_equal(request.path.substr(1, end - 1), token)) return;
    request.path.erase(0, end);
    request.headers.erase("Authorization");
    request.set_header("Authorization", bearer + token);
}

std::optional<Refusal> refusal_of(const httplib::Request& request, const HttpAccess& access) {
    const std::string host = request.get_header_value("Host");
    if (request.get_header_value_count("Host") != 1 || !is_served(host_of(host), access.host))
        return Refusal{403, "the view is not served to other hosts; see claray view --host"};
    if (is_of_another_site(request, access.framed) || is_of_another_origin(request, host))
        return Refusal{403, "the view is not served to pages of other sites"};
    if (!has_token(request, access.token))
        return Refusal{401, "a token is needed; open the address that claray view printed"};
    if (request.method != "GET" && request.method != "HEAD" && request.method != "POST")
        return Refusal{405, "use GET or POST"};
    return refusal_of_body(request);
}

}  // namespace claray::view
