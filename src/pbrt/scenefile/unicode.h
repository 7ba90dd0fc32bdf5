#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace pbrt {

/// Offset of the first byte that is not part of valid UTF-8 (overlong forms, surrogates and values beyond U+10FFFF are
/// not valid); nullopt if all is well.
std::optional<size_t> FindInvalidUtf8(std::string_view text);

/// Unicode normalisation form C of valid UTF-8, so that names typed with combining marks equal precomposed ones. What
/// is not valid is returned unchanged.
std::string ComposeUtf8(std::string_view text);

}  // namespace pbrt
