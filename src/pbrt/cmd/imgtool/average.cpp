#include <fmt/ranges.h>

#include "pbrt/cmd/imgtool/commands.h"

namespace pbrt::imgtool {

namespace {

struct AverageOptions {
    std::vector<std::string> names;
    std::string outfile;
};

int Average(const AverageOptions &o) {
    const std::vector<std::string> paths = FindImages(o.names, {o.outfile});
    ImageFile first = ReadAsFloat(paths[0]);
    std::vector<double> sums(first.image.ValueCount(), 0);
    for (const std::string &path : paths) {
        const ImageFile file = path == paths[0] ? first : ReadAsFloat(path);
        CheckComparable(first, paths[0], file, path);
        const float *values = static_cast<const float *>(file.image.Data());
        for (size_t i = 0; i < sums.size(); ++i) sums[i] += static_cast<double>(values[i]);
    }
    float *values = static_cast<float *>(first.image.Data());
    for (size_t i = 0; i < sums.size(); ++i)
        values[i] = static_cast<float>(sums[i] / static_cast<double>(paths.size()));
    WriteImage(o.outfile, first.image, first.metadata);
    fmt::print("{}: mean of {}: {}\n", o.outfile, CountText(paths.size(), "image"), fmt::join(paths, ", "));
    return 0;
}

}  // namespace

void AddAverage(CLI::App &app, Action &action) {
    auto [command, o] = AddCommand(app, action, Average, "average", "Mean of several images",
                                   "Example: imgtool average runs/seed --outfile mean.exr");
    AddFlags(command, {Flag("images", o.names, kImagesHelp).Required(),
                       Flag("--outfile", o.outfile,
                            "Result; not averaged itself, even if a pattern or the start of a name fits it")
                           .Required()
                           .Type("FILE")});
}

}  // namespace pbrt::imgtool
