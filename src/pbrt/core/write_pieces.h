#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace pbrt {

/// WriteFile (core/files.h) for a content in pieces, which are written one after the other: for files that are not in
/// memory as a whole.
void WriteFile(const std::string &path, const std::vector<std::string_view> &pieces);

}  // namespace pbrt
