#pragma once
#include <gtest/gtest.h>

#include "pbrt/cameras/camera.h"
#include "support/given_params.h"

namespace pbrt::test {

inline std::unique_ptr<Camera> MakeTestCamera(const std::string &type, const ParamSet &params = Params(),
                                              Point2i resolution = {40, 20}, const Transform &renderFromCamera = {},
                                              DiagnosticSink *sink = nullptr) {
    DiagnosticSink local;
    return Cameras().Make(type, params,
                          CameraContext{renderFromCamera, resolution, 35, FileResolver(), sink ? *sink : local});
}

struct NamedCamera {
    std::string name;
    std::unique_ptr<Camera> camera;
};
/// All that need no lens file; the pictures of the spherical ones are `width` wide.
inline std::vector<NamedCamera> AllCameras(const Transform &t, int width) {
    const Params lens = Params().Number("lensradius", 0.2f).Number("focaldistance", 4),
                 equirectangular = Params().String("mapping", "equirectangular");
    std::vector<NamedCamera> all;
    all.push_back({"perspective", MakeTestCamera("perspective", Params(), {40, 20}, t)});
    all.push_back({"perspective, lens", MakeTestCamera("perspective", lens, {40, 20}, t)});
    all.push_back({"orthographic", MakeTestCamera("orthographic", Params(), {40, 20}, t)});
    all.push_back({"orthographic, lens", MakeTestCamera("orthographic", lens, {40, 20}, t)});
    all.push_back({"equal-area", MakeTestCamera("spherical", Params(), {width, width}, t)});
    all.push_back({"equirectangular", MakeTestCamera("spherical", equirectangular, {width, width / 2}, t)});
    return all;
}

inline CameraRay RayAt(const Camera &camera, const Point2 &film, const Point2 &lens = {0.5f, 0.5f}, Float time = 0) {
    std::optional<CameraRay> ray = camera.GenerateRay({film, lens, time, 1}, SampledWavelengths());
    return ray.value();
}

/// The point where a ray meets the plane z = depth.
inline Point3 AtDepth(const Ray &ray, Float depth) { return ray((depth - ray.o.z) / ray.d.z); }

inline void ExpectClose(const Vector3 &a, const Vector3 &b, Float tolerance, const char *what = "") {
    EXPECT_LE(Distance(a, b), tolerance) << what << ": (" << a.x << " " << a.y << " " << a.z << ") and (" << b.x << " "
                                         << b.y << " " << b.z << ")";
}

}  // namespace pbrt::test
