#include <cmath>
#include <nlohmann/json.hpp>

#include "pbrt/cmd/imgtool/commands.h"

namespace pbrt::imgtool {
namespace {

struct DiffOptions {
    std::string path, reference, channels, metric = "MSE", outfile;
    std::vector<int> crop;
    bool json = false;
};

double Mean(const Image &image) {
    FiniteMean mean;
    ForEachValue(image, [&](Point2i p, int c) { mean.Add(double(image.Get(p, c))); });
    return mean.Mean();
}

/// Crops two images and checks that they can be compared: also parts of one image, if the files say which.
void CropBoth(ImageFile &a, const std::string &pathA, ImageFile &b, const std::string &pathB,
              const std::vector<int> &crop, const std::string &hint = "") {
    if (!a.metadata.pixelBounds || !b.metadata.pixelBounds || a.metadata.fullResolution != b.metadata.fullResolution)
        CheckComparable(a, pathA, b, pathB, hint);
    ApplyCrop(a, crop, pathA);
    ApplyCrop(b, crop, pathB);
    CheckComparable(a, pathA, b, pathB, hint);
}

int Diff(const DiffOptions &o) {
    const Metric metric = ChosenMetric(o.metric);
    ImageFile image = ReadAsFloat(o.path), reference = ReadAsFloat(o.reference);
    if (!o.channels.empty()) {
        const std::vector<std::string> names = SplitChannels(o.channels);
        image.image = image.image.Select(names, o.path + ":");
        reference.image = reference.image.Select(names, o.reference + ":");
    }
    CropBoth(image, o.path, reference, o.reference, o.crop, "; choose with --channels");

    Image errors;
    size_t skipped = 0;
    const double error = ImageError(image.image, reference.image, metric, &errors, &skipped);
    if (!o.outfile.empty()) WriteImage(o.outfile, errors, image.metadata);
    const int status = error == 0 && skipped == 0 ? 0 : 1;
    if (o.json) {
        const nlohmann::ordered_json json = {
            {"file", o.path},      {"reference", o.reference},  {"metric", o.metric},
            {"error", error},      {"mean", Mean(image.image)}, {"referenceMean", Mean(reference.image)},
            {"notFinite", skipped}};
        fmt::print("{}\n", json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
        return status;
    }
    if (status == 0) return 0;
    const double ours = Mean(image.image), theirs = Mean(reference.image);
    fmt::print("Images differ: {} and {}\n", o.path, o.reference);
    fmt::print("  averages: {:.6g} and {:.6g}", ours, theirs);
    if (theirs != 0) fmt::print(" ({:+.4g}% delta)", 100 * (ours - theirs) / theirs);
    fmt::print("\n  {}: {:.6g}\n", o.metric, error);
    const bool flip = metric == Metric::FLIP || metric == Metric::HdrFLIP;
    if (skipped) fmt::print("  {} values are not finite and {}\n", skipped, flip ? "count as 0" : "were left out");
    return 1;
}

struct ErrorOptions {
    std::vector<std::string> names;
    std::string reference, metric = "MSE", errorfile;
    std::vector<int> crop;
};

int Error(const ErrorOptions &o) {
    const Metric metric = ChosenMetric(o.metric);
    const std::vector<std::string> paths = FindImages(o.names, {o.reference, o.errorfile});
    const ImageFile whole = ReadAsFloat(o.reference);
    ImageFile reference;
    double sum = 0, squares = 0;
    size_t skipped = 0;
    Image terms;
    std::vector<double> termSums;
    for (const std::string &path : paths) {
        ImageFile file = ReadAsFloat(path);
        reference = whole;
        CropBoth(file, path, reference, o.reference, o.crop);
        size_t skippedHere = 0;
        const double error = ImageError(file.image, reference.image, metric, &terms, &skippedHere);
        if (paths.size() > 1) fmt::print("{}: {:.6g}\n", path, error);
        sum += error;
        squares += error * error;
        skipped += skippedHere;
        termSums.resize(terms.ValueCount(), 0);
        const auto *values = static_cast<const float *>(terms.Data());
        for (size_t i = 0; i < termSums.size(); ++i) termSums[i] += double(values[i]);
    }
    const auto n = double(paths.size());
    if (!o.errorfile.empty()) {
        auto *values = static_cast<float *>(terms.Data());
        for (size_t i = 0; i < termSums.size(); ++i) values[i] = float(termSums[i] / n);
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

void AddDiff(CLI::App &app, Action &action) {
    auto [command, o] =
        AddCommand(app, action, Diff, "diff", "Compare an image with a reference",
                   "Prints nothing and exits with 0 only if the error is exactly 0; else exits with 1.\n"
                   "Example: imgtool diff render.exr --reference reference.exr --metric relL2 --outfile error.exr");
    AddFlags(
        command,
        {Flag("file", o.path, "Image").Required(),
         Flag("--reference", o.reference, "Image to compare with").Required().Type("FILE"),
         Flag("--metric", o.metric,
              "MAE, MSE, MRSE (mean of (x - ref)^2 / (ref + 0.01)^2), relL2 (mean of (x - ref)^2 / (ref^2 + 0.01 "
              "m^2), m the mean of ref), relL2Abs (the paper's: 0.01 instead of 0.01 m^2), SMAPE (mean of |x - "
              "ref| / ((|x| + |ref|) / 2 + 0.01)), FLIP (seen at 67 pixels per degree; R, G, B clamped to 0..1) "
              "or HDR-FLIP (largest FLIP over exposures from the brightest value of the reference to its median)")
             .ShowDefault()
             .Type("NAME"),
         Flag("--channels", o.channels, "Compare only these channels").Type("R,G,B"),
         CropFlag(o.crop),
         Flag("--outfile", o.outfile, "Write the error of every pixel and channel; FLIP: of every pixel").Type("FILE"),
         {"--json", o.json, "Print a JSON object, also if the images are equal"}});
}

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
