#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "pbrt/cameras/camera.h"
#include "support/param.h"

namespace pbrt::test {

inline std::unique_ptr<Camera> MakeTestCamera(const std::string &type, const std::vector<Param> &params,
                                              Point2i resolution = {40, 20}, const Transform &renderFromCamera = {},
                                              DiagnosticSink *sink = nullptr) {
    ParamSet set("Camera \"" + type + "\"", {});
    for (const Param &p : params) set.Add(p);
    DiagnosticSink local;
    return Cameras().Make(type, set,
                          CameraContext{renderFromCamera, resolution, 35, FileResolver(), sink ? *sink : local});
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
