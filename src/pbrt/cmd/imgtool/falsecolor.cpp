#include <algorithm>
#include <cmath>

#include "pbrt/cmd/imgtool/commands.h"
#include "pbrt/images/false_color.h"

namespace pbrt::imgtool {
namespace {

struct FalsecolorOptions {
    std::string path, outfile;
    std::optional<Float> maxValue;
    bool plusMinus = false, ramp = false;
};

constexpr int kLegendRows = 16;
constexpr int kShown = 99;  // percentile of the default range

struct Range {
    Float max = 1, largest = 0;
};

// With the maximum, a few bright pixels would turn all others black.
Range ChooseRange(std::vector<Float> values) {
    Range range;
    if (values.empty()) return range;
    const auto at = values.begin() + ((values.size() * kShown + 99) / 100 - 1);
    std::nth_element(values.begin(), at, values.end());
    range.largest = *std::max_element(at, values.end());
    range.max = *at > 0 ? *at : range.largest > 0 ? range.largest : 1;
    return range;
}

int Falsecolor(const FalsecolorOptions &o) {
    const ImageFile file = ReadAsFloat(o.path);
    const Image mean = AverageChannels(file.image);
    std::vector<Float> sizes;
    ForEachPixel(mean, [&](Point2i p) {
        const Float v = mean.Get(p, 0);
        if (std::isfinite(v)) sizes.push_back(o.plusMinus ? std::abs(v) : v);
    });
    FalseColorStyle style;
    style.scale = o.plusMinus ? FalseColorStyle::Scale::Signed : FalseColorStyle::Scale::Ramp;
    const Range range = ChooseRange(std::move(sizes));
    style.max = o.maxValue.value_or(range.max);
    style.legendRows = o.ramp ? kLegendRows : 0;
    ImageMetadata metadata;
    if (!o.ramp) {
        metadata.pixelBounds = file.metadata.pixelBounds;
        metadata.fullResolution = file.metadata.fullResolution;
    }
    WriteImage(o.outfile, FalseColor(mean, 0, style), metadata);
    fmt::print("{}: {} to {}", o.outfile, o.plusMinus ? -style.max : 0, style.max);
    if (!o.maxValue && range.largest > style.max)
        fmt::print(", which {} % of the pixels do not exceed; the largest value is {}", kShown, range.largest);
    fmt::print("\n");
    return 0;
}

}  // namespace

void AddFalsecolor(CLI::App &app, Action &action) {
    auto [command, o] =
        AddCommand(app, action, Falsecolor, "falsecolor", "Show the mean of each pixel's channels as a colour",
                   "Values that are not finite become magenta.\n"
                   "Example: imgtool falsecolor error.exr error.png --maxvalue 0.5 --ramp");
    AddFlags(command, {Flag("file", o.path, "Image").Required(),
                       OutfileFlag(o.outfile, true),
                       {"--maxvalue", o.maxValue,
                        "Value of the last colour (default: 99 % of the pixels have no larger one)", PositiveNumber},
                       {"--plusminus", o.plusMinus, "Blue for negative, black for 0, red for positive"},
                       {"--ramp", o.ramp, "Add a bar of all colours below the image"}});
}

}  // namespace pbrt::imgtool
