#pragma once
#include "pbrt/scenefile/parser.h"

namespace pbrt {

/// Parses text as file `name` in directory `directory`.
inline SceneDescription ParseSceneText(const std::string &text, DiagnosticSink &sink,
                                       const std::string &name = "<text>", const std::string &directory = "") {
    DescriptionBuilder builder(sink);
    FileResolver files{std::filesystem::path(directory)};
    auto file = std::make_shared<const SourceFile>(SourceFile{name, text});
    const bool complete = ReadDirectives(file, name, files, builder);
    return builder.Finish(complete, FileLoc{file, 0, 0}, std::move(files));
}

}  // namespace pbrt
