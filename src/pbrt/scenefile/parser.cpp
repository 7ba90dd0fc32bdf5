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

}  // namespace pbrt
