/// URIs in glTF: base64 data, or files beside the scene.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace relumbre {

/// Bytes in a well-formed base64 data URI ("data:...;base64,..."), or nothing if it is not one.
std::optional<std::size_t> data_uri_size(std::string_view uri);

/// The relative path a URI names, percent-decoded, or nothing if it has a scheme, is absolute,
/// leaves its folder through "..", or holds control characters.
std::optional<std::string> decode_relative_uri(std::string_view uri);

}  // namespace relumbre
