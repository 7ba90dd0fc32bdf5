#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "pbrt/media/medium_factory.h"
#include "support/given_params.h"
#include "support/statistics.h"

namespace pbrt::test {

inline std::unique_ptr<Medium> MakeMedium(const std::string &type, const ParamSet &params, const Transform &place,
                                          DiagnosticSink &sink) {
    return Media().Make(type, params, MediumContext{place, ColorSpace::SRGB(), FileResolver(), sink});
}
/// Fails the test if there are warnings.
inline std::unique_ptr<Medium> MakeMedium(const std::string &type, const ParamSet &params,
                                          const Transform &place = {}) {
    DiagnosticSink sink;
    auto medium = MakeMedium(type, params, place, sink);
    for (const Diagnostic &d : sink.All()) ADD_FAILURE() << d.message;
    return medium;
}

inline const std::string kBlob = PBRT_SOURCE_DIR "/tests/conformance/suite/scenes/assets/blob.nvdb";

/// Transformations that place media: each is hard in its own way.
inline std::vector<Transform> Places() {
    glm::mat4 shear(1);
    shear[1][0] = 0.7f;
    shear[2][1] = -0.4f;
    return {Transform(),
            Transform::Translate({3, -2, 5}) * Transform::Rotate(35, {1, 2, 3}) * Transform::Scale({2, 0.5f, 1.5f}),
            Transform::Scale({-1, 1, 1}) * Transform::Rotate(70, {0, 1, 0}),
            Transform::Translate({0.3f, 0, 0}) * Transform(shear)};
}

inline Params CountOf(const glm::ivec3 &n) { return Params().Integer("nx", n.x).Integer("ny", n.y).Integer("nz", n.z); }
inline size_t SizeOf(const glm::ivec3 &n) { return size_t(n.x * n.y * n.z); }
inline std::vector<Float> RandomValues(size_t count, Rng &rng, Float emptyShare) {
    std::vector<Float> v(count);
    for (Float &x : v) x = rng.Uniform() < emptyShare ? 0 : 2 * rng.Uniform();
    return v;
}

struct NamedMedium {
    std::string name;
    std::unique_ptr<Medium> medium;
    Transform place;
    Bounds3 bounds;  ///< in its own space
};

/// A uniformgrid with much empty space in it.
inline NamedMedium MakeSparseGrid(const Transform &place, std::vector<Float> *densities = nullptr) {
    const glm::ivec3 n(9, 5, 21);
    Rng rng(5);
    std::vector<Float> density = RandomValues(SizeOf(n), rng, 0.6f);
    if (densities) *densities = density;
    Params p = CountOf(n);
    p.Floats(ParamType::Float, "density", density).Rgb("sigma_a", 0.5f, 1, 1.5f).Rgb("sigma_s", 2, 1, 0);
    p.Point("p0", {-1, -1, -1}).Point("p1", {1, 0.5f, 2});
    return {"uniformgrid", MakeMedium("uniformgrid", p, place), place, {{-1, -1, -1}, {1, 0.5f, 2}}};
}

/// One medium of every type, at a place.
inline std::vector<NamedMedium> AllMedia(const Transform &place) {
    std::vector<NamedMedium> all;
    Params homogeneous;
    homogeneous.Rgb("sigma_a", 0.5f, 1, 1.5f).Rgb("sigma_s", 0.3f, 0.1f, 0);
    all.push_back({"homogeneous", MakeMedium("homogeneous", homogeneous, place), place, {{-1, -1, -1}, {1, 1, 1}}});
    all.push_back(MakeSparseGrid(place));
    const glm::ivec3 n(3, 20, 4);
    Rng rng(9);
    std::vector<Float> colors = RandomValues(3 * SizeOf(n), rng, 0.4f);
    Params rgb = CountOf(n);
    rgb.Floats(ParamType::Rgb, "sigma_a", colors)
        .Floats(ParamType::Rgb, "sigma_s", RandomValues(3 * SizeOf(n), rng, 0));
    all.push_back({"rgbgrid", MakeMedium("rgbgrid", rgb, place), place, {{0, 0, 0}, {1, 1, 1}}});
    Params cloud;
    cloud.Number("density", 1.5f).Number("frequency", 4);
    all.push_back({"cloud", MakeMedium("cloud", cloud, place), place, {{0, 0, 0}, {1, 1, 1}}});
    Params vdb;
    vdb.String("filename", kBlob).Rgb("sigma_a", 1, 2, 3);
    all.push_back({"nanovdb", MakeMedium("nanovdb", vdb, place), place, {{-1, -1, -1}, {1, 1, 1}}});
    return all;
}

inline Ray RayThrough(const Point3 &from, const Point3 &to) { return {.o = from, .d = Normalize(to - from)}; }
/// A point of the box, or of one a little larger.
inline Point3 PointNear(const Bounds3 &b, Rng &rng, Float larger = 0) {
    const Vector3 u(rng.Uniform(), rng.Uniform(), rng.Uniform());
    return b.low + b.Diagonal() * (u * (1 + 2 * larger) - larger);
}

inline const SampledWavelengths kLambda = SampledWavelengths::SampleVisible(Float(0.3));

}  // namespace pbrt::test
