#include <cmath>

#include "pbrt/cmd/imgtool/commands.h"
#include "pbrt/core/error.h"
#include "pbrt/images/false_color.h"

namespace pbrt::imgtool {

namespace {

struct Options {
    std::string path, outfile;
    std::optional<Float> maxValue;
    bool plusMinus = false, ramp = false;
};

constexpr int LegendRows = 16;

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
    Image mean(PixelFormat::Float, resolution, {"Y"});
    Float most = 0;
    for (int y = 0; y < resolution.y; ++y)
        for (int x = 0; x < resolution.x; ++x) {
            const Float v = ColorMean(image, {x, y});
            mean.Set({x, y}, 0, v);
            if (std::isfinite(v)) most = std::max(most, o.plusMinus ? std::abs(v) : v);
        }
    FalseColorStyle style;
    style.scale = o.plusMinus ? FalseColorStyle::Scale::Signed : FalseColorStyle::Scale::Ramp;
    style.most = o.maxValue.value_or(most > 0 ? most : 1);
    style.legendRows = o.ramp ? LegendRows : 0;
    WriteImage(o.outfile, FalseColor(mean, 0, style));
    fmt::print("{}: {} to {}\n", o.outfile, o.plusMinus ? -style.most : 0, style.most);
    return 0;
}

}  // namespace

void AddFalsecolor(CLI::App &app, Action &action) {
    auto o = std::make_shared<Options>();
    CLI::App *command = app.add_subcommand("falsecolor", "Show the mean of each pixel's channels as a colour");
    command->add_option("file", o->path, "Image")->required();
    AddOutfileOption(*command, o->outfile);
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
