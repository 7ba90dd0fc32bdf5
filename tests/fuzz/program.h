#pragma once
#include "fuzz/child.h"
#include "fuzz/fuzz_case.h"

namespace pbrt::fuzz {

/// Loads and sets up, without threads, what every run of pbrt would load, so that forked children have it. Run in the
/// working folder of a child: writes and removes files there.
void PrepareProgram(const std::string &folder);

/// Runs the program pbrt on the case's files, which lie in the working folder, and looks at the picture. For a child.
int RunProgram(const FuzzCase &fuzzCase, PictureReport &report);

/// Looks at the picture that the program wrote.
void LookAtPicture(const std::string &path, PictureReport &report);

}  // namespace pbrt::fuzz
