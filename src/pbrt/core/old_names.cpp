#include <algorithm>

#include "pbrt/core/error.h"

namespace pbrt {
namespace {

struct Replacement {
    const char *what;
    std::vector<std::string_view> names;
    const char *instead;
};

/// Names of pbrt-v3.
const std::vector<Replacement> kReplacements = {
    {"directive", {"WorldEnd"}, "delete it, as the world ends with the file"},
    {"directive", {"Renderer"}, "delete it; \"Integrator\" sets the integrator"},
    {"directive", {"SurfaceIntegrator"}, "use \"Integrator\""},
    {"directive", {"VolumeIntegrator"}, "delete it, and use Integrator \"volpath\""},
    {"directive", {"Volume"}, "use \"MakeNamedMedium\" and \"MediumInterface\""},
    {"directive", {"SearchPath"}, "delete it; file names are relative to the scene file"},
    {"parameter type", {"color"}, "write \"rgb\""},
    {"parameter type", {"xyz"}, "write \"rgb\", converted"},
    {"parameter type", {"point"}, "write \"point3\""},
    {"parameter type", {"vector"}, "write \"vector3\""},
    {"kind of texture", {"color"}, "write \"spectrum\""},
    {"Material", {"matte"}, "use \"diffuse\" with \"reflectance\""},
    {"Material", {"plastic", "uber", "substrate", "disney"}, "use \"coateddiffuse\" with \"reflectance\""},
    {"Material", {"translucent"}, "use \"diffusetransmission\" with \"reflectance\" and \"transmittance\""},
    {"Material", {"glass"}, "use \"dielectric\" with \"eta\""},
    {"Material", {"metal", "shinymetal"}, "use \"conductor\""},
    {"Material", {"mirror"}, "use \"conductor\" with \"roughness\" 0"},
    {"Material", {"fourier"}, "use \"measured\", whose files differ"},
    {"Material", {"kdsubsurface"}, "use \"subsurface\" with \"reflectance\" and \"mfp\""},
    {"Material", {"none"}, "use \"interface\""},
    {"Film", {"image"}, "use \"rgb\""},
    {"Sampler", {"lowdiscrepancy", "maxmindist", "bestcandidate", "adaptive"}, "use \"zsobol\""},
    {"Sampler", {"02sequence", "zerotwosequence"}, "use \"paddedsobol\""},
    {"Sampler", {"random"}, "use \"independent\""},
    {"Integrator", {"directlighting"}, "use \"path\" with \"integer maxdepth\" 1, or more for mirrors"},
    {"Integrator", {"whitted", "igi", "irradiancecache"}, "use \"path\" or \"volpath\""},
    {"Integrator", {"photonmap", "exphotonmap"}, "use \"sppm\""},
    {"Integrator", {"metropolis"}, "use \"mlt\""},
    {"Integrator", {"emission", "single"}, "use \"volpath\""},
    {"Camera", {"environment"}, "use \"spherical\""},
    {"LightSource", {"exinfinite", "infinitesample"}, "use \"infinite\""},
    {"AreaLightSource", {"area"}, "use \"diffuse\""},
    {"Accelerator", {"grid", "none"}, "use \"bvh\""},
    {"Shape",
     {"cone", "paraboloid", "hyperboloid", "heightfield", "heightfield2", "nurbs"},
     "use \"trianglemesh\" or \"plymesh\""},
    {"Shape", {"plyfile"}, "use \"plymesh\""},
    {"parameter", {"Kd"}, "use \"reflectance\""},
    {"parameter", {"Kr", "Ks"}, "use \"reflectance\" (\"eta\" and \"k\" for a metal)"},
    {"parameter", {"Kt"}, "use \"transmittance\", or \"eta\" of a dielectric"},
    {"parameter", {"index"}, "use \"eta\""},
    {"parameter", {"mapname"}, "use \"filename\""},
    {"parameter", {"bumpmap"}, "use \"displacement\""},
    {"parameter", {"nsamples", "samples", "directlighting", "rrthreshold"}, "leave it out"},
    {"parameter", {"st"}, "use \"uv\""},
    {"parameter", {"lightsamplestrategy"}, "use \"lightsampler\""},
    {"parameter", {"gamma"}, "use \"encoding\""},
    {"parameter", {"trilinear"}, "use \"filter\""},
};

constexpr const char *kWasRemoved = "it was removed (docs/develop/negative-results.md)";

/// Names of earlier versions of this program.
const std::vector<Replacement> kOwnReplacements = {
    {"parameter", {"octree.windows"}, "it is \"string octree.portals\" now"},
    {"parameter", {"octree.tiles", "octree.opensky", "equiangular", "shadowgate"}, kWasRemoved},
    {"suffix", {"gate"}, kWasRemoved},
};

const char *Find(const std::vector<Replacement> &replacements, std::string_view what, std::string_view name) {
    for (const auto &[kind, names, instead] : replacements)
        if (kind == what && std::ranges::find(names, name) != names.end()) return instead;
    return nullptr;
}

}  // namespace

std::string OldNameHint(std::string_view what, std::string_view name) {
    if (const char *own = Find(kOwnReplacements, what, name)) return fmt::format("{}; ", own);
    if (const char *instead = Find(kReplacements, what, name))
        return fmt::format("it is of pbrt-v3: {} (pbrt-v4's own \"pbrt --upgrade\" converts most of a scene); ",
                           instead);
    return {};
}

}  // namespace pbrt
