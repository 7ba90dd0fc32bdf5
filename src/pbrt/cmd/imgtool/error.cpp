#include <cmath>

#include "pbrt/cmd/imgtool/commands.h"

namespace pbrt::imgtool {

namespace {

struct ErrorOptions {
    std::vector<std::string> names;
    std::string reference, metric = "MSE", errorfile;
    std::vector<int> crop;
};

int Error(const ErrorOptions &o) {
    const Metric metric = ChosenMetric(o.metric);
    const std::vector<std::string> paths = FindImages(o.names, {o.reference, o.errorfile});
    const ImageFile whole = ReadAsFloat(o.reference);
    ImageFile reference = whole;
    ApplyCrop(reference, o.crop, o.reference);

    double sum = 0, squares = 0;
    size_t skipped = 0;
    Image terms;
    std::vector<double> termSums;
    for (const std::string &path : paths) {
        ImageFile file = ReadAsFloat(path);
        CheckComparable(file, path, whole, o.reference);
        ApplyCrop(file, o.crop, path);
        size_t skippedHere = 0;
        const double error = ImageError(file.image, reference.image, metric, &terms, &skippedHere);
        if (paths.size() > 1) fmt::print("{}: {:.6g}\n", path, error);
        sum += error;
        squares += error * error;
        skipped += skippedHere;
        termSums.resize(terms.ValueCount(), 0);
        const auto *values = static_cast<const float *>(terms.Data());
        for (size_t i = 0; i < termSums.size(); ++i) termSums[i] += static_cast<double>(values[i]);
    }
    const auto n = static_cast<double>(paths.size());
    if (!o.errorfile.empty()) {
        auto *values = static_cast<float *>(terms.Data());
        for (size_t i = 0; i < termSums.size(); ++i) values[i] = static_cast<float>(termSums[i] / n);
        WriteImage(o.errorfile, terms, reference.metadata);
    }
    fmt::print("{}: mean {:.6g}", o.metric, sum / n);
    if (paths.size() > 1)
        fmt::print(", standard deviation {:.3g}", std::sqrt(std::max(0.0, (squares - sum * sum / n) / (n - 1))));
    fmt::print(", {}\n", paths.size() == 1 ? paths[0] : fmt::format("{} images", paths.size()));
    if (skipped) fmt::print("  {} values are not finite\n", skipped);
    return 0;
}

}  // namespace

void AddError(CLI::App &app, Action &action) {
    auto [command, o] =
        AddCommand(app, action, Error, "error", "Errors of several images, and their mean",
                   "Example: imgtool error runs/seed --reference reference.exr --metric MRSE --errorfile error.exr");
    AddFlags(
        command,
        {Flag("images", o.names, kImagesHelp).Required(),
         Flag("--reference", o.reference,
              "Image to compare with; not compared itself, even if a pattern or the start of a name fits it")
             .Required()
             .Type("FILE"),
         Flag("--metric", o.metric, "MAE, MSE, MRSE, relL2, relL2Abs, SMAPE, FLIP or HDR-FLIP; see imgtool help diff")
             .ShowDefault()
             .Type("NAME"),
         CropFlag(o.crop),
         Flag("--errorfile", o.errorfile, "Write the mean error of every pixel and channel").Type("FILE")});
}

}  // namespace pbrt::imgtool
