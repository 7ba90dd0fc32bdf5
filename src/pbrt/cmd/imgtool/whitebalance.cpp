#include "pbrt/cmd/imgtool/commands.h"
#include "pbrt/spectra/rgb_primaries.h"

namespace pbrt::imgtool {

namespace {

struct WhitebalanceOptions {
    std::string path, outfile, illuminant;
    std::vector<Float> primaries;
    std::optional<Float> temperature;
};

/// The prefix of a name is optional: A is stdillum-A.
Point2 WhiteOfIlluminant(const std::string &name) {
    std::vector<std::string> choices;
    for (const std::string &known : NamedSpectrumNames())
        if (known.starts_with("stdillum-") || known.starts_with("illum-")) {
            choices.push_back(known);
            if (name == known || name == known.substr(known.find('-') + 1))
                return Chromaticity(SpectrumToXyz(*NamedSpectrum(known)));
        }
    throw UserError(fmt::format("--illuminant {}: unknown; {}", name, ListChoices(name, choices)));
}

Point2 White(const WhitebalanceOptions &o) {
    if (!o.illuminant.empty()) return WhiteOfIlluminant(o.illuminant);
    if (o.temperature) return Chromaticity(SpectrumToXyz(DaylightSpectrum(*o.temperature)));
    if (o.primaries.empty()) throw UserError("One of --illuminant, --primaries and --temperature is needed.");
    const Point2 white(o.primaries[0], o.primaries[1]);
    if (!(white.x > 0 && white.y > 0 && white.x + white.y < 1))
        throw UserError(
            fmt::format("--primaries {},{}: not the chromaticity of a white; x and y are above 0 and x + y "
                        "below 1.",
                        white.x, white.y));
    return white;
}

int Whitebalance(const WhitebalanceOptions &o) {
    const Point2 white = White(o);
    ImageFile file = ReadAsFloat(o.path);
    const std::array<int, 3> rgb = RgbChannels(file.image, o.path);
    const ColorSpace &space = SpaceOf(file);
    const glm::mat3 m = space.RgbFromXyz() * WhiteBalanceMatrix(white, space.White()) * space.XyzFromRgb();
    ForEachPixel(file.image, [&](Point2i p) { SetRgb(file.image, p, rgb, m * GetRgb(file.image, p, rgb)); });
    WriteImage(o.outfile, file.image, file.metadata);
    return 0;
}

}  // namespace

void AddWhitebalance(CLI::App &app, Action &action) {
    auto [command, o] = AddCommand(app, action, Whitebalance, "whitebalance",
                                   "Turn the white of a given light into the white of the image's colour space",
                                   "Adaptation after von Kries in Bradford's cone space.\n"
                                   "Example: imgtool whitebalance lamp.exr --temperature 2800 --outfile white.exr");
    AddFlags(
        command,
        {Flag("file", o.path, "Image with the channels R, G, B").Required(),
         OutfileFlag(o.outfile, true),
         Flag("--illuminant", o.illuminant, "The light: a standard illuminant, for instance A or D50").Type("NAME"),
         Flag("--primaries", o.primaries, "The light: its chromaticity").Count(2).Type("x,y"),
         {"--temperature", o.temperature, "The light: daylight of this temperature in kelvin, below 4000 a black body",
          CLI::Range(1000.0, 25000.0)}});
    CLI::Option *primaries = command.get_option("--primaries"), *temperature = command.get_option("--temperature");
    command.get_option("--illuminant")->excludes(primaries)->excludes(temperature);
    primaries->excludes(temperature);
}

}  // namespace pbrt::imgtool
