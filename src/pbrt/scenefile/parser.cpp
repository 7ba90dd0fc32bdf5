#include "pbrt/scenefile/parser.h"

#include <filesystem>
#include <utility>

#include "pbrt/scenefile/description_builder.h"
#include "pbrt/scenefile/directive_reader.h"
#include "pbrt/scenefile/tokenizer.h"

namespace pbrt {

namespace {

/// Parses one top-level file. Returns false if an error ended the parse early.
bool ParseFile(std::shared_ptr<const SourceFile> file, std::string key, const FileResolver &files,
               DescriptionBuilder &builder) {
    try {
        Tokenizer tokens;
        tokens.Push(std::move(file), std::move(key));
        DirectiveReader(tokens, builder, files).Run();
        return true;
    } catch (const UserError &e) {
        builder.Sink().Add(e);
        return false;
    }
}

}  // namespace

SceneDescription ParseSceneFiles(const std::vector<std::string> &paths, DiagnosticSink &sink) {
    DescriptionBuilder builder(sink);
    FileResolver files;
    FileLoc where;
    bool complete = true;
    // After a syntax error the state is undefined, and following files would give false errors.
    for (size_t i = 0; i < paths.size() && complete; ++i) {
        const std::string &path = paths[i];
        files = path == "-" ? FileResolver() : FileResolver(std::filesystem::path(path).parent_path());
        try {
            auto file = OpenSceneFile(path, ReadFrom::FilesAndPipes);
            where = {file, 0, 0};
            complete = ParseFile(std::move(file), SceneFileKey(path), files, builder);
        } catch (const UserError &e) {
            sink.Add(e);
            complete = false;
        }
    }
    return builder.Finish(complete, where, std::move(files));
}

SceneDescription ParseSceneText(const std::string &text, DiagnosticSink &sink, const std::string &name,
                                const std::string &directory) {
    DescriptionBuilder builder(sink);
    FileResolver files{std::filesystem::path(directory)};
    auto file = std::make_shared<const SourceFile>(SourceFile{name, text});
    bool complete = ParseFile(file, name, files, builder);
    return builder.Finish(complete, FileLoc{file, 0, 0}, std::move(files));
}

}  // namespace pbrt
