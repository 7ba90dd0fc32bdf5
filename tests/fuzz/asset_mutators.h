#pragma once
#include <string>

#include "fuzz/fuzz_case.h"

namespace pbrt::fuzz {

/// The kind of mutation an asset falls under, after its format: "ply-ascii", "ply-binary", "ply-gz", "exr", ...
std::string AssetKind(const CaseFile &asset);

/// Changes the file once, in most cases where its format stores counts, sizes and types.
void MutateAsset(CaseFile &asset, Dice &dice);

}  // namespace pbrt::fuzz
