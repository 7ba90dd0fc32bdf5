#pragma once
#include "pbrt/scenefile/description_builder.h"
#include "pbrt/scenefile/tokenizer.h"

namespace pbrt {

/// Parses files in sequence as one scene ("-" = standard input). A syntax error ends the parse of its file and all
/// following ones. Errors and warnings are collected in `sink`; the caller decides with sink.ThrowIfErrors().
SceneDescription ParseSceneFiles(const std::vector<std::string> &paths, DiagnosticSink &sink);

/// Reads the directives of a top-level or imported file and calls the builder. `key` identifies the file; `outer`:
/// tokenizer of the importing file. Returns false if an error, reported to the builder's sink, ended the file early.
bool ReadDirectives(std::shared_ptr<const SourceFile> file, std::string key, const FileResolver &files,
                    DescriptionBuilder &builder, const Tokenizer *outer = nullptr);

}  // namespace pbrt
