#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace pbrt {

/// Offset of the first byte of invalid UTF-8 (including overlong forms, surrogates and values beyond U+10FFFF); nullopt
/// if valid.
std::optional<size_t> FindInvalidUtf8(std::string_view text);

/// Unicode normalisation form C, so that names with combining marks equal precomposed ones. Returns invalid UTF-8
/// unchanged.
std::string ComposeUtf8(std::string_view text);

}  // namespace pbrt
