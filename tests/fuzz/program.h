#pragma once
#include "fuzz/child.h"
#include "fuzz/fuzz_case.h"

namespace pbrt::fuzz {

/// Loads and sets up everything that each run of pbrt needs, without threads, so that forked children have it. Writes
/// and removes files in the current folder, which must be the working folder of a child.
void PrepareProgram(const std::string &folder);

/// The folder of lightlab's experiment and references, below the working folder. A case with a reference removes it.
constexpr const char *kLabFolder = "lab";

/// Runs pbrt or lightlab on the case's files, which lie in the working folder, and looks at the picture. For a child.
int RunProgram(const FuzzCase &fuzzCase, PictureReport &report);

/// Reads the picture that the program wrote and reports on it.
void LookAtPicture(const std::string &path, PictureReport &report);

}  // namespace pbrt::fuzz
