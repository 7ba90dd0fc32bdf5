#pragma once
#include <string>
#include <vector>

#include "fuzz/fuzz_case.h"

namespace pbrt::fuzz {

/// Small files of every format that scenes can name, made by code: images of 8 x 8 pixels, meshes of a dozen faces, a
/// measured BSDF, a lens, a spectrum. Always the same bytes. `folder` is for temporary files.
std::vector<CaseFile> MakeAssets(const std::string &folder);

/// gzip of `bytes`, and back. Uncompress returns what could be uncompressed.
std::string Compress(const std::string &bytes);
std::string Uncompress(const std::string &bytes);

}  // namespace pbrt::fuzz
