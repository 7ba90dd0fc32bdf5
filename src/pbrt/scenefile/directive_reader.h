#pragma once
#include <memory>
#include <string>

#include "pbrt/core/files.h"
#include "pbrt/scenefile/description_builder.h"
#include "pbrt/scenefile/tokenizer.h"

namespace pbrt {

/// Reads the directives of a top-level or imported file and calls the builder. `key`: SceneFileKey; `outer`: tokenizer
/// of the importing file. Returns false if an error, which is reported to the builder's sink, ended the file early.
bool ReadDirectives(std::shared_ptr<const SourceFile> file, std::string key, const FileResolver &files,
                    DescriptionBuilder &builder, const Tokenizer *outer = nullptr);

/// Reads a file, or standard input for "-"; throws UserError (no location) on failure.
std::shared_ptr<const SourceFile> OpenSceneFile(const std::string &path, ReadFrom from = ReadFrom::Files);
/// Canonical key of a file, independent of how its name is written.
std::string SceneFileKey(const std::string &path);

}  // namespace pbrt
