#include "pbrt/spectra/spectrum_params.h"

#include <algorithm>

#include "pbrt/core/log.h"

namespace pbrt {
namespace {

void RequireCount(const Param &p, size_t found, size_t wanted) {
    if (found != wanted)
        throw UserError(p.loc, "\"{} {}\" takes {}, found {}.", Name(p.type), p.name, CountText(wanted, "value"),
                        found);
}

SpectrumPtr FromRgb(const Param &p, SpectrumUse use) {
    RequireCount(p, p.floats.size(), 3);
    Rgb rgb(p.floats[0], p.floats[1], p.floats[2]);
    auto complain = [&](const char *what) {
        throw UserError(p.loc, "\"rgb {}\" [ {} {} {} ]: {}.", p.name, rgb.x, rgb.y, rgb.z, what);
    };
    if (rgb.x < 0 || rgb.y < 0 || rgb.z < 0) complain("a component is negative");
    if (!std::isfinite(rgb.x) || !std::isfinite(rgb.y) || !std::isfinite(rgb.z))
        complain("a component is infinite or not a number");
    if (MaxComponent(rgb) > kMaxBrightness) complain("a component is above 1e+30");
    const ColorSpace *space = ColorSpace::Find(p.colorSpace);
    PBRT_CHECK_MSG(space, "colour space \"{}\"", p.colorSpace);
    switch (use) {
        case SpectrumUse::Albedo:
            if (rgb.x > 1 || rgb.y > 1 || rgb.z > 1)
                complain("a component is above 1, but reflectances and other albedos must lie in [0, 1]");
            return std::make_shared<RgbAlbedoSpectrum>(*space, rgb);
        case SpectrumUse::Unbounded: return std::make_shared<RgbUnboundedSpectrum>(*space, rgb);
        case SpectrumUse::Illuminant: break;
    }
    return std::make_shared<RgbIlluminantSpectrum>(*space, rgb);
}

SpectrumPtr FromBlackbody(const Param &p) {
    RequireCount(p, p.floats.size(), 1);
    constexpr Range<Float> kTemperatures = Positive(1e9f);
    if (!kTemperatures.Contains(p.floats[0]))
        throw UserError(p.loc, "\"blackbody {}\": {} K; the temperature must be {}.", p.name, p.floats[0],
                        Text(kTemperatures));
    return std::make_shared<BlackbodySpectrum>(p.floats[0]);
}

SpectrumPtr FromSamples(std::span<const Float> samples, SpectrumUse use, const std::string &where, const FileLoc &loc) {
    auto fail = [&](const std::string &what) { throw UserError(loc, "{}: {}.", where, what); };
    if (samples.empty()) fail("no samples; wavelength and value pairs are required");
    if (samples.size() % 2 != 0)
        fail(fmt::format("odd number of values ({}); wavelength and value pairs are required", samples.size()));
    std::vector<Float> lambdas, values;
    for (size_t i = 0; i < samples.size(); i += 2) {
        if (!lambdas.empty() && !(samples[i] > lambdas.back()))
            fail(fmt::format("wavelengths must increase, but {} nm follows {} nm (pair {})", samples[i], lambdas.back(),
                             i / 2 + 1));
        if (use == SpectrumUse::Illuminant && !(samples[i + 1] >= 0))
            fail(fmt::format("the value at {} nm is {}; no light emits less than 0", samples[i], samples[i + 1]));
        lambdas.push_back(samples[i]);
        values.push_back(samples[i + 1]);
    }
    if (lambdas.size() == 1) {
        const std::string place = loc ? fmt::format("{}:{}:{}: ", loc.file->name, loc.line, loc.column) : "";
        LogWarning(place + where + ": a single wavelength and value pair; the spectrum is 0 everywhere else.");
    }
    return std::make_shared<PiecewiseLinearSpectrum>(std::move(lambdas), std::move(values));
}

SpectrumPtr FromSpectrum(const Param &p, SpectrumUse use, const FileResolver &files) {
    if (p.strings.empty()) return FromSamples(p.floats, use, fmt::format("\"spectrum {}\"", p.name), p.loc);
    RequireCount(p, p.strings.size(), 1);
    const std::string &name = p.strings[0];
    if (SpectrumPtr named = NamedSpectrum(name)) return named;
    std::string path = files.Resolve(name);
    if (!FileExists(path))
        throw UserError(p.loc, "\"spectrum {}\": \"{}\" is neither a file nor a built-in spectrum; {}.", p.name, name,
                        ListChoices(name, NamedSpectrumNames()));
    std::vector<Float> samples;
    try {
        samples = ReadNumberFile(path);
    } catch (const UserError &e) {
        throw UserError(e.Diagnostics().front().message, p.loc);
    }
    return FromSamples(samples, use, path, p.loc);
}

}  // namespace

SpectrumPtr SpectrumParam::Make(const FileResolver &files) const {
    if (!given && named) return NamedSpectrum(named);
    if (!given) return constant ? std::make_shared<ConstantSpectrum>(*constant) : nullptr;
    switch (given->type) {
        case ParamType::Rgb: return FromRgb(*given, use);
        case ParamType::Blackbody: return FromBlackbody(*given);
        case ParamType::Float:
            RequireCount(*given, given->floats.size(), 1);
            return std::make_shared<ConstantSpectrum>(given->floats[0]);
        default: return FromSpectrum(*given, use, files);
    }
}

/// The entity's own parameter overrides Attribute defaults, whose last applies. Own ones of two types are an error.
void ReadParam(ParamReader &reader, const std::string &name, SpectrumParam &value) {
    static constexpr std::array kTypes = {ParamType::Float, ParamType::Rgb, ParamType::Blackbody, ParamType::Spectrum};
    const auto types = std::span(kTypes).subspan(value.takesFloat ? 0 : 1);
    value.set = &reader.Set();
    value.given = value.set->FindIf(name, [&](ParamType type) { return std::ranges::count(types, type) > 0; });
    for (ParamType type : types)
        if (const Param *p = reader.Take(name, type); p && p != value.given && !p->fromAttribute)
            throw UserError(value.given->loc, "{}: \"{}\" is given both as \"{}\" and as \"{}\".", value.set->What(),
                            name, Name(p->type), Name(value.given->type));
}

void DocumentParam(ParamDoc &doc, const SpectrumParam &value) {
    if (value.takesFloat) doc.types = {ParamType::Float};
    doc.types.insert(doc.types.end(), {ParamType::Rgb, ParamType::Blackbody, ParamType::Spectrum});
    if (value.constant) doc.defaultValue = fmt::format("{}", *value.constant);
    if (value.named) doc.defaultValue = value.named;
}

UserError NoLuminanceError(const ParamSet &set, const char *parameter, const Spectrum &emission) {
    // Spectra are read at whole nanometres.
    constexpr int kStepsPerNm = 100;
    bool isBetween = false;
    for (int i = int(LambdaMin) * kStepsPerNm; i < int(LambdaMax) * kStepsPerNm && !isBetween; ++i)
        isBetween = emission(Float(double(i) / kStepsPerNm)) > 0;
    return set.Error(parameter,
                     "\"{}\" emits nothing that the eye can see, so it cannot be scaled to photometric units{}.",
                     parameter, isBetween ? " (lines narrower than 1 nm between whole nanometres have no effect)" : "");
}

}  // namespace pbrt
