#include "pbrt/core/number_file.h"

#include <cctype>
#include <cmath>
#include <cstdlib>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"

namespace pbrt {

std::vector<Float> ReadNumberFile(const std::string &path) {
    const std::string text = ReadFileContents(path);
    std::vector<Float> numbers;
    int line = 1;
    const char *at = text.c_str(), *end = at + text.size();
    while (at < end) {
        if (*at == '\n') ++line;
        if (std::isspace(static_cast<unsigned char>(*at))) {
            ++at;
        } else if (*at == '#') {
            while (at < end && *at != '\n') ++at;
        } else {
            char *after = nullptr;
            Float value = std::strtof(at, &after);
            bool separated =
                after > at && (after >= end || std::isspace(static_cast<unsigned char>(*after)) || *after == '#');
            if (!separated || !std::isfinite(value))
                throw UserError(fmt::format(
                    "{}:{}: expected a number; this file may contain only finite numbers and # comments.", path, line));
            numbers.push_back(value);
            at = after;
        }
    }
    return numbers;
}

}  // namespace pbrt
