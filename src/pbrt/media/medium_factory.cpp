#include "pbrt/media/medium_factory.h"

#include "pbrt/media/medium_kinds.h"
#include "pbrt/media/voxel_media.h"
#include "pbrt/spectra/spectrum_params.h"

namespace pbrt {
namespace {

constexpr Float kMaxCoefficient = 1e30f;
constexpr Range<Float> kCoefficientRange{0, kMaxCoefficient};
constexpr const char *kGHelp = "Henyey-Greenstein asymmetry; above 0: forward";
constexpr const char *kScaleHelp = "factor of absorption and scattering";
constexpr const char *kEmissionScaleHelp = "factor of emission";

/// `factor` times the spectrum. Throws if a value is negative or too large.
DenseSpectrum Coefficient(const ParamSet &set, const char *name, const Spectrum &s, Float factor) {
    for (Float nm = LambdaMin; nm <= LambdaMax; ++nm) {
        const Float value = factor * s(nm);
        if (!kCoefficientRange.Contains(value))
            throw set.Error(name, "\"{}\" times all that scales it is {:.4g} at {} nm; it must be {}.", name, value, nm,
                            Text(kCoefficientRange));
    }
    return ScaledSpectrum(s, factor);
}

struct CoefficientParams {
    SpectrumParam absorption{SpectrumUse::Unbounded, Float(1)}, scattering{SpectrumUse::Unbounded, Float(1)};
    Float g = 0;
    void Describe(auto &&v) {
        v("sigma_a", absorption, "absorption per unit length");
        v("sigma_s", scattering, "scattering per unit length");
        v("g", g, Range<Float>{-1, 1}, kGHelp);
    }
    MediumSpectra Make(const ParamSet &set, const MediumContext &context, Float scale) const {
        return {Coefficient(set, "sigma_a", *absorption.Make(context.files), scale),
                Coefficient(set, "sigma_s", *scattering.Make(context.files), scale),
                ScaledSpectrum(ConstantSpectrum(0), 0)};
    }
};

/// Emission "Le", scaled like lights so that scale 1 is one photometric unit; black if absent.
DenseSpectrum Emission(const ParamSet &set, const MediumContext &context, const SpectrumParam &given, Float scale) {
    if (!given) return ScaledSpectrum(ConstantSpectrum(0), 0);
    const SpectrumPtr emission = given.Make(context.files);
    if (!(emission->MaxValue() > 0)) return ScaledSpectrum(*emission, 0);
    const Float photometric = SpectrumToPhotometric(*emission);
    if (!(photometric > 0)) throw NoLuminanceError(set, "Le", *emission);
    return Coefficient(set, "Le", *emission, scale / photometric);
}

const Transform &RequirePlace(const ParamSet &set, const MediumContext &context) {
    const Transform &t = context.renderFromMedium;
    const glm::mat4 &m = t.Matrix();
    if (t.IsSingular() || !t.IsFinite())
        throw set.Error("", "the current transformation cannot be inverted, so the medium has no place.");
    if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1)
        throw set.Error("", "the current transformation is a projection, which cannot place a medium.");
    return t;
}

constexpr Items kPosition{ParamType::Point3, kCoordinateRange};

struct BoundsParams {
    Point3 p0{0, 0, 0}, p1{1, 1, 1};
    void Describe(auto &&v) {
        v("p0", p0, kPosition, "corner of the medium's box, in its space");
        v("p1", p1, kPosition, "opposite corner");
    }
    Bounds3 Make(const ParamSet &set) const {
        for (int a = 0; a < 3; ++a)
            if (p0[a] == p1[a])
                throw set.Error(set.Has("p1") ? "p1" : "p0",
                                "\"p0\" and \"p1\" have the same coordinate {}, {}, so the box is flat.", "xyz"[a],
                                p0[a]);
        return {p0, p1};
    }
};

struct CountParams {
    int x = 1, y = 1, z = 1;
    void Describe(auto &&v) {
        constexpr Range<int> kCounts{1, 1 << 20};
        v("nx", x, kCounts, "voxels along x, fastest in lists");
        v("ny", y, kCounts, "voxels along y");
        v("nz", z, kCounts, "voxels along z");
    }
    glm::ivec3 Count() const { return {x, y, z}; }
    int64_t Size() const { return int64_t(x) * y * z; }
    void RequireSize(const ParamSet &set, const char *name, size_t found) const {
        if (int64_t(found) != Size())
            throw set.Error(name, "\"{}\" has {} values; nx * ny * nz = {} x {} x {} = {} are required.", name, found,
                            x, y, z, Size());
    }
};

/// A list with one number per voxel, or empty.
std::vector<Float> VoxelValues(const ParamSet &set, const CountParams &count, const char *name,
                               std::span<const Float> given, Range<Float> range) {
    if (given.empty()) return {};
    count.RequireSize(set, name, given.size());
    for (size_t i = 0; i < given.size(); ++i)
        if (!range.Contains(given[i]))
            throw set.Error(name, "value {} of \"{}\" is {}; it must be {}.", i + 1, name, given[i], Text(range));
    return {given.begin(), given.end()};
}

struct ThermalParams {
    std::optional<Float> offset, cutoff;
    Float factor = 1;
    void Describe(auto &&v) {
        v("temperatureoffset", offset, AnyFloat("K"), "subtracted from temperatures; default 0");
        v("temperaturecutoff", cutoff, AnyFloat("K"), "another name of temperatureoffset");
        v("temperaturescale", factor, kCoefficientRange, "factor of temperatures, after the offset");
    }
    ThermalEmission Make(const ParamSet &set, Float scale) const {
        if (offset && cutoff)
            throw set.Error(
                "temperaturecutoff",
                "\"temperatureoffset\" and \"temperaturecutoff\" are the same parameter and cannot be given together.");
        return {offset.value_or(cutoff.value_or(0)), factor, scale};
    }
};

const ScatteringPreset *FindPreset(const std::string &name) {
    const auto &all = EmbeddedScatteringPresets();
    const auto found = std::ranges::find(all, name, &ScatteringPreset::name);
    return found == all.end() ? nullptr : &*found;
}

struct HomogeneousParams {
    std::string preset;
    CoefficientParams coefficients;
    SpectrumParam emission{SpectrumUse::Illuminant};
    Float emissionScale = 1, scale = 1;
    void Describe(auto &&v) {
        v("preset", preset, "known substance; sets sigma_a and sigma_s, per millimetre");
        if (v.When(!FindPreset(preset))) {
            v("sigma_a", coefficients.absorption, "absorption per unit length");
            v("sigma_s", coefficients.scattering, "scattering per unit length");
        }
        v("g", coefficients.g, Range<Float>{-1, 1}, kGHelp);
        v("Le", emission, "emitted radiance per unit length, times sigma_a");
        v("Lescale", emissionScale, kBrightnessRange, kEmissionScaleHelp);
        v("scale", scale, kCoefficientRange, kScaleHelp);
    }
};

MediumSpectra PresetSpectra(const ParamSet &set, const ScatteringPreset &preset, Float scale) {
    auto spectrum = [&](const std::array<Float, 3> &rgb) {
        return Coefficient(set, "scale", RgbUnboundedSpectrum(ColorSpace::SRGB(), Rgb(rgb[0], rgb[1], rgb[2])), scale);
    };
    // As in stock pbrt-v4, the table's reduced scattering is used as scattering for any g.
    return {spectrum(preset.absorption), spectrum(preset.reducedScattering), ScaledSpectrum(ConstantSpectrum(0), 0)};
}

std::unique_ptr<Medium> MakeHomogeneous(const HomogeneousParams &p, const ParamSet &set, const MediumContext &context) {
    const ScatteringPreset *preset = FindPreset(p.preset);
    if (!preset && !p.preset.empty()) {
        std::vector<std::string> names;
        for (const ScatteringPreset &known : EmbeddedScatteringPresets()) names.push_back(known.name);
        set.Warn(context.sink, "preset",
                 fmt::format("there is no preset \"{}\", so \"sigma_a\" and \"sigma_s\" are used; {}.",
                             Abbreviate(p.preset), ListChoices(p.preset, names)));
    }
    MediumSpectra spectra = preset ? PresetSpectra(set, *preset, p.scale) : p.coefficients.Make(set, context, p.scale);
    spectra.emission = Emission(set, context, p.emission, p.emissionScale);
    return std::make_unique<HomogeneousMedium>(std::move(spectra), p.coefficients.g);
}

struct UniformGridParams {
    CoefficientParams coefficients;
    Float scale = 1;
    CountParams count;
    BoundsParams bounds;
    std::span<const Float> density, temperature, emissionScale;
    SpectrumParam emission{SpectrumUse::Illuminant};
    ThermalParams thermal;
    void Describe(auto &&v) {
        v("density", density, Required(), "factor of absorption and scattering per voxel");
        count.Describe(v);
        bounds.Describe(v);
        coefficients.Describe(v);
        v("scale", scale, kCoefficientRange, kScaleHelp);
        v("Le", emission, "emitted radiance per unit length, times absorption");
        v("Lescale", emissionScale, "factor of emission per voxel; default: 1 in the middle of the box, less outside");
        v("temperature", temperature, "emission temperature (K) per voxel; not with Le");
        thermal.Describe(v);
    }
};

std::unique_ptr<Medium> MakeUniformGrid(const UniformGridParams &p, const ParamSet &set, const MediumContext &context) {
    if (p.emission && !p.temperature.empty())
        throw set.Error("temperature", "\"Le\" and \"temperature\" cannot be given together.");
    UniformGridMedium::Grids grids;
    grids.count = p.count.Count();
    grids.density = VoxelValues(set, p.count, "density", p.density, kCoefficientRange);
    grids.emission = VoxelValues(set, p.count, "Lescale", p.emissionScale, kBrightnessRange);
    grids.temperature = VoxelValues(set, p.count, "temperature", p.temperature, AnyFloat("K"));
    MediumSpectra spectra = p.coefficients.Make(set, context, p.scale);
    spectra.emission = Emission(set, context, p.emission, 1);
    const Float densest = *std::max_element(grids.density.begin(), grids.density.end());
    for (const DenseSpectrum *s : {&spectra.absorption, &spectra.scattering})
        set.Require("density", densest * s->MaxValue(), kCoefficientRange);
    return std::make_unique<UniformGridMedium>(std::move(spectra), p.coefficients.g, RequirePlace(set, context),
                                               p.bounds.Make(set), std::move(grids), p.thermal.Make(set, 1));
}

struct RgbGridParams {
    CountParams count;
    BoundsParams bounds;
    std::vector<Rgb> absorption, scattering, emission;
    Float emissionScale = 1, scale = 1, g = 0;
    void Describe(auto &&v) {
        constexpr Items kCoefficients{ParamType::Rgb, kCoefficientRange}, kRadiances{ParamType::Rgb, kBrightnessRange};
        v("sigma_a", absorption, kCoefficients, "absorption per voxel; default beside sigma_s: 1");
        v("sigma_s", scattering, kCoefficients, "scattering per voxel; default beside sigma_a: 1");
        v("Le", emission, kRadiances, "emitted radiance per unit length, times sigma_a (required); not photometric");
        count.Describe(v);
        bounds.Describe(v);
        v("Lescale", emissionScale, kBrightnessRange, kEmissionScaleHelp);
        v("scale", scale, kCoefficientRange, kScaleHelp);
        v("g", g, Range<Float>{-1, 1}, kGHelp);
    }
};

const ColorSpace &SpaceOf(const ParamSet &set, const char *name, const MediumContext &context) {
    const Param *p = set.Find(name, ParamType::Rgb);
    const ColorSpace *space = p ? ColorSpace::Find(p->colorSpace) : nullptr;
    return space ? *space : context.colorSpace;
}

std::unique_ptr<Medium> MakeRgbGrid(const RgbGridParams &p, const ParamSet &set, const MediumContext &context) {
    if (p.absorption.empty() && p.scattering.empty())
        throw set.Error("", "it needs \"rgb sigma_a\" or \"rgb sigma_s\".");
    if (!p.emission.empty() && p.absorption.empty())
        throw set.Error("Le", "\"rgb Le\" needs \"rgb sigma_a\", because only what absorbs emits.");
    auto spectra = [&](const char *name, const std::vector<Rgb> &colors, Float factor) {
        std::vector<RgbUnboundedSpectrum> all;
        if (colors.empty()) return all;
        p.count.RequireSize(set, name, colors.size());
        const ColorSpace &space = SpaceOf(set, name, context);
        all.reserve(colors.size());
        for (const Rgb &color : colors) {
            all.emplace_back(space, color);
            set.Require(name, factor * all.back().MaxValue(), kCoefficientRange);
        }
        return all;
    };
    RgbGridMedium::Grids grids{.count = p.count.Count(),
                               .absorption = spectra("sigma_a", p.absorption, p.scale),
                               .scattering = spectra("sigma_s", p.scattering, p.scale),
                               .emission = spectra("Le", p.emission, p.emissionScale),
                               .illuminant = &SpaceOf(set, "Le", context).Illuminant(),
                               .scale = p.scale,
                               .emissionScale = p.emissionScale};
    return std::make_unique<RgbGridMedium>(p.g, RequirePlace(set, context), p.bounds.Make(set), std::move(grids));
}

struct CloudParams {
    CoefficientParams coefficients;
    CloudMedium::Shape shape;
    BoundsParams bounds;
    void Describe(auto &&v) {
        v("density", shape.density, kCoefficientRange, "density");
        v("wispiness", shape.wispiness, kCoefficientRange, "distortion of fine features");
        v("frequency", shape.frequency, kCoefficientRange, "features per unit length");
        bounds.Describe(v);
        coefficients.Describe(v);
    }
};

struct NanoVdbParams {
    std::string filename, gridName = "density", temperatureName = "temperature";
    CoefficientParams coefficients;
    Float emissionScale = 1, scale = 1;
    ThermalParams thermal;
    void Describe(auto &&v) {
        v("filename", filename, Required(), "NanoVDB file");
        v("gridname", gridName, "grid of factors of absorption and scattering");
        v("temperaturename", temperatureName, "grid of emission temperatures (K), if present");
        v("Lescale", emissionScale, kBrightnessRange, kEmissionScaleHelp);
        thermal.Describe(v);
        coefficients.Describe(v);
        v("scale", scale, kCoefficientRange, kScaleHelp);
    }
};

}  // namespace

const MediumFactories &Media() {
    static const MediumFactories table("Medium", [](MediumFactories &t) {
        t.Add<HomogeneousParams>("homogeneous", "a medium that is the same everywhere", MakeHomogeneous);
        t.Add<UniformGridParams>("uniformgrid", "a box of voxels with densities", MakeUniformGrid);
        t.Add<RgbGridParams>("rgbgrid", "a box of voxels with colours", MakeRgbGrid);
        t.Add<CloudParams>("cloud", "a box with a cloud made of noise",
                           [](const auto &p, const ParamSet &set, auto &c) {
                               return std::make_unique<CloudMedium>(p.coefficients.Make(set, c, 1), p.coefficients.g,
                                                                    RequirePlace(set, c), p.bounds.Make(set), p.shape);
                           });
        t.Add<NanoVdbParams>("nanovdb", "voxels from a NanoVDB file", [](const auto &p, const ParamSet &set, auto &c) {
            MediumSpectra spectra = p.coefficients.Make(set, c, p.scale);
            const Transform &place = RequirePlace(set, c);
            const NanoVdbRequest request{c.files.Resolve(p.filename), p.gridName, p.temperatureName,
                                         p.thermal.Make(set, p.emissionScale)};
            return set.At("filename",
                          [&] { return MakeNanoVdbMedium(request, std::move(spectra), p.coefficients.g, place); });
        });
    });
    return table;
}

}  // namespace pbrt
