#include "pbrt/scenefile/parser.h"

#include <filesystem>
#include <utility>

#include "pbrt/scenefile/directive_reader.h"

namespace pbrt {

SceneDescription ParseSceneFiles(const std::vector<std::string> &paths, DiagnosticSink &sink) {
    DescriptionBuilder builder(sink);
    FileResolver files;
    FileLoc where;
    bool complete = true;
    // After a syntax error the state is undefined, and following files would give false errors.
    for (size_t i = 0; i < paths.size() && complete; ++i) {
        const std::string &path = paths[i];
        files = path == "-" ? FileResolver() : FileResolver(std::filesystem::path(path).parent_path());
        std::shared_ptr<const SourceFile> file;
        complete = Collect(sink, [&] { file = OpenSceneFile(path, ReadFrom::FilesAndPipes); });
        if (!complete) break;
        where = {file, 0, 0};
        complete = ReadDirectives(std::move(file), SceneFileKey(path), files, builder);
    }
    return builder.Finish(complete, where, std::move(files));
}

SceneDescription ParseSceneText(const std::string &text, DiagnosticSink &sink, const std::string &name,
                                const std::string &directory) {
    DescriptionBuilder builder(sink);
    FileResolver files{std::filesystem::path(directory)};
    auto file = std::make_shared<const SourceFile>(SourceFile{name, text});
    bool complete = ReadDirectives(file, name, files, builder);
    return builder.Finish(complete, FileLoc{file, 0, 0}, std::move(files));
}

}  // namespace pbrt
