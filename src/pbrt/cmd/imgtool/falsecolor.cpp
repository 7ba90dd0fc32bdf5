#include <cmath>

#include "pbrt/cmd/imgtool/commands.h"
#include "pbrt/core/error.h"

namespace pbrt::imgtool {

namespace {

struct Options {
    std::string path, outfile;
    std::optional<Float> maxValue;
    bool plusMinus = false, ramp = false;
};

// Encoded colours from low to high, dark to bright, so that order shows without the legend as well.
constexpr std::array<Rgb, 6> Colors = {Rgb(0.02f, 0.02f, 0.10f), Rgb(0.25f, 0.10f, 0.55f), Rgb(0.05f, 0.45f, 0.65f),
                                       Rgb(0.15f, 0.70f, 0.30f), Rgb(0.95f, 0.80f, 0.15f), Rgb(1.00f, 0.98f, 0.90f)};

Rgb RampColor(Float t) {
    const Float x = std::clamp(t, Float(0), Float(1)) * (Colors.size() - 1);
    const size_t i = std::min(static_cast<size_t>(x), Colors.size() - 2);
    return Lerp(x - static_cast<Float>(i), Colors[i], Colors[i + 1]);
}

// -1 blue, 0 black, 1 red.
Rgb SignedColor(Float t) {
    const Float x = std::clamp(t, Float(-1), Float(1));
    return x < 0 ? Lerp(-x, Rgb(0), Rgb(0.25f, 0.55f, 1)) : Lerp(x, Rgb(0), Rgb(1, 0.35f, 0.2f));
}

constexpr int LegendRows = 16;
const Rgb InvalidColor(1, 0, 1);

Float ColorMean(const Image &image, Point2i p) {
    Float sum = 0;
    int count = 0;
    for (int c = 0; c < image.ChannelCount(); ++c) {
        if (image.Channels()[static_cast<size_t>(c)] == "A") continue;
        sum += image.Get(p, c);
        ++count;
    }
    return count ? sum / static_cast<Float>(count) : 0;
}

int Falsecolor(const Options &o) {
    const Image image = ReadAsFloat(o.path).image;
    const Point2i resolution = image.Resolution();
    Float most = 0;
    for (int y = 0; y < resolution.y; ++y)
        for (int x = 0; x < resolution.x; ++x) {
            const Float v = ColorMean(image, {x, y});
            if (std::isfinite(v)) most = std::max(most, o.plusMinus ? std::abs(v) : v);
        }
    const Float maxValue = o.maxValue.value_or(most > 0 ? most : 1);

    // Colours are chosen as shown, so they pass the PNG encoding unchanged.
    Image result(PixelFormat::Float, {resolution.x, resolution.y + (o.ramp ? LegendRows : 0)}, {"R", "G", "B"});
    const ColorEncoding shown{};
    auto put = [&](int x, int y, const Rgb &color) {
        for (int c = 0; c < 3; ++c) result.Set({x, y}, c, shown.ToLinear(color[c]));
    };
    for (int y = 0; y < resolution.y; ++y)
        for (int x = 0; x < resolution.x; ++x) {
            const Float v = ColorMean(image, {x, y}) / maxValue;
            put(x, y, !std::isfinite(v) ? InvalidColor : o.plusMinus ? SignedColor(v) : RampColor(v));
        }
    for (int y = resolution.y; y < result.Resolution().y; ++y)
        for (int x = 0; x < resolution.x; ++x) {
            const Float t = (static_cast<Float>(x) + Float(0.5)) / static_cast<Float>(resolution.x);
            put(x, y, o.plusMinus ? SignedColor(2 * t - 1) : RampColor(t));
        }
    WriteImage(o.outfile, result);
    fmt::print("{}: {} to {}\n", o.outfile, o.plusMinus ? -maxValue : 0, maxValue);
    return 0;
}

}  // namespace

void AddFalsecolor(CLI::App &app, Action &action) {
    auto o = std::make_shared<Options>();
    CLI::App *command = app.add_subcommand("falsecolor", "Show the mean of each pixel's channels as a colour");
    command->add_option("file", o->path, "Image")->required();
    command->add_option("--outfile", o->outfile, "Result: .exr, .png or .pfm")->required()->type_name("FILE");
    command->add_option("--maxvalue", o->maxValue, "Value of the last colour (default: the image's largest)")
        ->check(CLI::PositiveNumber);
    command->add_flag("--plusminus", o->plusMinus, "Blue for negative, black for 0, red for positive");
    command->add_flag("--ramp", o->ramp, "Add a bar of all colours below the image");
    command->footer(
        "Values that are not finite become magenta.\n"
        "Example: imgtool falsecolor error.exr --maxvalue 0.5 --ramp --outfile error.png");
    command->callback([o, &action] { action = [o] { return Falsecolor(*o); }; });
}

}  // namespace pbrt::imgtool
