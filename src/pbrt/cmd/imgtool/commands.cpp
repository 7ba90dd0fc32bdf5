#include "pbrt/cmd/imgtool/commands.h"

#include <fnmatch.h>

#include <algorithm>
#include <filesystem>

#include "pbrt/core/files.h"

namespace pbrt::imgtool {

std::vector<std::string> FindImages(const std::vector<std::string> &names, const std::vector<std::string> &except) {
    namespace fs = std::filesystem;
    static const std::vector<std::string> kKnown = {".exr", ".png", ".pfm",  ".hdr", ".jpg", ".jpeg", ".tga", ".bmp",
                                                    ".gif", ".tif", ".tiff", ".ppm", ".pgm", ".pnm",  ".psd", ".qoi"};
    std::error_code code;
    std::vector<std::string> files;
    auto add = [&](const std::string &file) {
        const auto isFile = [&](const std::string &e) { return fs::equivalent(file, e, code); };
        if (std::ranges::count(files, file) == 0 && std::ranges::none_of(except, isFile)) files.push_back(file);
    };
    for (const std::string &name : names) {
        if (fs::is_regular_file(name, code)) {
            add(name);
            continue;
        }
        const fs::path path(name);
        const std::string last = path.filename().string();
        const bool isPattern = last.find_first_of("*?") != std::string::npos;
        std::vector<std::string> found;
        for (const fs::directory_entry &entry :
             fs::directory_iterator(path.has_parent_path() ? path.parent_path() : fs::path("."), code)) {
            const std::string here = entry.path().filename().string();
            const bool fits = isPattern
                                  ? fnmatch(last.c_str(), here.c_str(), FNM_PERIOD) == 0
                                  : here.starts_with(last) && std::ranges::count(kKnown, LowerExtension(here)) > 0;
            if (fits && entry.is_regular_file(code))
                found.push_back(path.has_parent_path() ? entry.path().string() : here);
        }
        if (found.empty())
            throw UserError(isPattern
                                ? fmt::format("No file fits \"{}\".", name)
                                : fmt::format("No file is called \"{}\", and no image's name starts with it.", name));
        std::sort(found.begin(), found.end());
        for (const std::string &file : found) add(file);
    }
    if (files.empty()) throw UserError("There is no image but {}.", except[0]);
    return files;
}

}  // namespace pbrt::imgtool
