#include "pbrt/core/v3_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace pbrt {

namespace {

struct Replacement {
    std::string_view what, name, instead;
};

constexpr std::string_view kMesh = "use \"trianglemesh\" or \"plymesh\"", kDelete = "leave it out",
                           kPath = "use \"path\" or \"volpath\"", kZsobol = "use \"zsobol\"",
                           kCoated = "use \"coateddiffuse\" with \"reflectance\"",
                           kReflectance = "use \"reflectance\" (\"eta\" and \"k\" for a metal)";

constexpr Replacement kReplacements[] = {
    {"directive", "WorldEnd", "delete it, as the world ends with the file"},
    {"directive", "Renderer", "delete it; \"Integrator\" says how to render"},
    {"directive", "SurfaceIntegrator", "use \"Integrator\""},
    {"directive", "VolumeIntegrator", "delete it, and use Integrator \"volpath\""},
    {"directive", "Volume", "use \"MakeNamedMedium\" and \"MediumInterface\""},
    {"directive", "SearchPath", "delete it; file names are relative to the scene file"},
    {"parameter type", "color", "write \"rgb\""},
    {"parameter type", "xyz", "write \"rgb\", converted"},
    {"parameter type", "point", "write \"point3\""},
    {"parameter type", "vector", "write \"vector3\""},
    {"kind of texture", "color", "write \"spectrum\""},
    {"Material", "matte", "use \"diffuse\" with \"reflectance\""},
    {"Material", "plastic", kCoated},
    {"Material", "uber", kCoated},
    {"Material", "substrate", kCoated},
    {"Material", "disney", kCoated},
    {"Material", "translucent", "use \"diffusetransmission\" with \"reflectance\" and \"transmittance\""},
    {"Material", "glass", "use \"dielectric\" with \"eta\""},
    {"Material", "metal", "use \"conductor\""},
    {"Material", "mirror", "use \"conductor\" with \"roughness\" 0"},
    {"Material", "shinymetal", "use \"conductor\""},
    {"Material", "fourier", "use \"measured\", whose files differ"},
    {"Material", "kdsubsurface", "use \"subsurface\" with \"reflectance\" and \"mfp\""},
    {"Material", "none", "use \"interface\""},
    {"Film", "image", "use \"rgb\""},
    {"Sampler", "lowdiscrepancy", kZsobol},
    {"Sampler", "02sequence", "use \"paddedsobol\""},
    {"Sampler", "zerotwosequence", "use \"paddedsobol\""},
    {"Sampler", "maxmindist", kZsobol},
    {"Sampler", "bestcandidate", kZsobol},
    {"Sampler", "adaptive", kZsobol},
    {"Sampler", "random", "use \"independent\""},
    {"Integrator", "directlighting", "use \"path\" with \"integer maxdepth\" 1, or more for mirrors"},
    {"Integrator", "whitted", kPath},
    {"Integrator", "igi", kPath},
    {"Integrator", "irradiancecache", kPath},
    {"Integrator", "photonmap", "use \"sppm\""},
    {"Integrator", "exphotonmap", "use \"sppm\""},
    {"Integrator", "metropolis", "use \"mlt\""},
    {"Integrator", "emission", "use \"volpath\""},
    {"Integrator", "single", "use \"volpath\""},
    {"Camera", "environment", "use \"spherical\""},
    {"LightSource", "exinfinite", "use \"infinite\""},
    {"LightSource", "infinitesample", "use \"infinite\""},
    {"AreaLightSource", "area", "use \"diffuse\""},
    {"Accelerator", "grid", "use \"bvh\""},
    {"Accelerator", "none", "use \"bvh\""},
    {"Shape", "cone", kMesh},
    {"Shape", "paraboloid", kMesh},
    {"Shape", "hyperboloid", kMesh},
    {"Shape", "heightfield", kMesh},
    {"Shape", "heightfield2", kMesh},
    {"Shape", "nurbs", kMesh},
    {"Shape", "plyfile", "use \"plymesh\""},
    {"parameter", "Kd", "use \"reflectance\""},
    {"parameter", "Kr", kReflectance},
    {"parameter", "Ks", kReflectance},
    {"parameter", "Kt", "use \"transmittance\", or \"eta\" of a dielectric"},
    {"parameter", "index", "use \"eta\""},
    {"parameter", "mapname", "use \"filename\""},
    {"parameter", "bumpmap", "use \"displacement\""},
    {"parameter", "nsamples", kDelete},
    {"parameter", "samples", kDelete},
    {"parameter", "st", "use \"uv\""},
    {"parameter", "directlighting", kDelete},
    {"parameter", "rrthreshold", kDelete},
    {"parameter", "lightsamplestrategy", "use \"lightsampler\""},
    {"parameter", "gamma", "use \"encoding\""},
    {"parameter", "trilinear", "use \"filter\""},
};

}  // namespace

std::string V3Hint(std::string_view what, std::string_view name) {
    const auto *found = std::find_if(std::begin(kReplacements), std::end(kReplacements),
                                     [&](const Replacement &r) { return r.what == what && r.name == name; });
    if (found == std::end(kReplacements)) return {};
    return fmt::format("it is of pbrt-v3: {} (pbrt-v4's own \"pbrt --upgrade\" converts most of a scene); ",
                       found->instead);
}

}  // namespace pbrt
