// Data that stands in a URI (RFC 2397).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace claray {

/// "data:", in any case, and a comma.
[[nodiscard]] bool is_data_uri(std::string_view uri);

/// The bytes of a data URI of any type and parameters: in base64, of the usual alphabet or that for URLs, or as text
/// with %xx. Nothing where the base64 is broken.
[[nodiscard]] std::optional<std::string> decode_data_uri(std::string_view uri);

}  // namespace claray
