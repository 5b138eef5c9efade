// Which requests the web page of the view answers.
#pragma once

#include <optional>
#include <string>

namespace httplib {
struct Request;
}

namespace claray::view {

inline constexpr std::size_t longest_body = 4096;  ///< bytes; a command is a line

/// A host as URLs write it: in lower case, an IPv6 address in brackets.
[[nodiscard]] std::string url_host(const std::string& host);

/// The answer to a request that is refused before its body is read.
struct Refusal {
    int status = 0;  ///< of HTTP
    std::string why;
};

/// Judges a request by its method and headers alone. `served` is the host that the server listens at. Requests that
/// name another host, that come from a page of another origin, or whose body is long, compressed or of unknown length
/// are refused. "0.0.0.0" and "::" may be named in any way.
[[nodiscard]] std::optional<Refusal> refusal_of(const httplib::Request& request, const std::string& served);

}  // namespace claray::view
