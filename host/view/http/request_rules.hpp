// Which requests the web page of the view answers.
#pragma once

#include <optional>
#include <string>

#include "host/view/http/http.hpp"

namespace httplib {
struct Request;
}

namespace claray::view {

inline constexpr std::size_t longest_body = 4096;      ///< bytes; a command is a line
inline constexpr std::size_t longest_piece = 1 << 20;  ///< bytes of a file, which comes in pieces

/// A host as URLs write it: in lower case, an IPv6 address in brackets.
[[nodiscard]] std::string url_host(const std::string& host);

/// The answer to a request that is refused before its body is read.
struct Refusal {
    int status = 0;  ///< of HTTP
    std::string why;
};

/// Takes a token away that is the first folder of the path, and gives it as the header Authorization. So a page finds
/// its files by names that are relative, and needs no cookie, which browsers keep from frames of other sites.
void take_token(httplib::Request& request, const std::string& token);

/// Judges a request by its method and headers alone. Requests that name another host, that come from a page of another
/// origin, or whose body is long, compressed or of unknown length are refused. "0.0.0.0" and "::" may be named in any
/// way. Requests without the token are refused if it is not empty.
[[nodiscard]] std::optional<Refusal> refusal_of(const httplib::Request& request, const HttpAccess& access);
/// Bytes of the body of a request that is not refused.
[[nodiscard]] std::size_t body_of(const httplib::Request& request);

}  // namespace claray::view
