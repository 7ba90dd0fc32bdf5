// What the camera sees of a point is what its rays see there.
#include "camera_cases.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

/// Placed by a transformation that turns, mirrors and scales unevenly.
std::vector<NamedCamera> ConnectingCameras() {
    return AllCameras(
        Transform::Translate({1, 2, 3}) * Transform::Rotate(50, {1, 1, 0}) * Transform::Scale({-2, 1.5f, 2.5f}), 40);
}

/// The place where the ray of a film position meets the plane through p across w.
Point3 OnPlane(const Camera &camera, const Point2 &film, const Point2 &lens, const Point3 &p, const Vector3 &w) {
    const Ray ray = RayAt(camera, film, lens).ray;
    return ray(Dot(p - ray.o, w) / Dot(ray.d, w));
}

TEST(CameraConnection, IsTheRayOfItsPlaceAndThePixelsAreaThere) {
    for (const auto &[name, camera] : ConnectingCameras()) {
        ASSERT_TRUE(camera->CanConnect()) << name;
        Rng rng(3);
        for (int i = 0; i < 200; ++i) {
            const Point2 film = rng.Uniform2() * Point2(39, 19) + Point2(0.5f, 0.5f), lens = rng.Uniform2();
            // The equal-area map has creases, across which a pixel has no defined area.
            if (name == "equal-area" &&
                std::min({std::abs(film.x - film.y), std::abs(film.x - 20), std::abs(film.y - 20),
                          std::abs(film.x + film.y - 20), std::abs(film.x + film.y - 40)}) < 0.1f)
                continue;
            const Ray ray = RayAt(*camera, film, lens).ray;
            const Point3 p = ray(Float(0.5) + 10 * rng.Uniform());
            const std::optional<CameraConnection> seen = camera->Connect(p, lens, 0);
            ASSERT_TRUE(seen) << name;
            ExpectClose({seen->pFilm, 0}, {film, 0}, 2e-4f * 20, name.c_str());
            ExpectClose(seen->p, ray.o, 1e-5f, name.c_str());
            ExpectClose(seen->wi, -ray.d, 1e-5f, name.c_str());
            constexpr Float kStep = 0.02f;
            const auto across = [&](const Point2 &step) {
                return (OnPlane(*camera, film + kStep * step, lens, p, ray.d) -
                        OnPlane(*camera, film - kStep * step, lens, p, ray.d)) /
                       (2 * kStep);
            };
            const Float area = Length(Cross(across({1, 0}), across({0, 1})));
            EXPECT_NEAR(seen->weight * area, 1, 0.01) << name << " " << film.x << " " << film.y;
        }
    }
}

/// The density of rays depends on their direction alone: it is the weight of every point of the ray, however far.
TEST(CameraConnection, HasTheWeightOfTheRaysDirection) {
    for (const auto &[name, camera] : ConnectingCameras()) {
        Rng rng(5);
        for (int i = 0; i < 200; ++i) {
            const Point2 lens = rng.Uniform2();
            const Ray ray = RayAt(*camera, rng.Uniform2() * Point2(40, 20), lens).ray;
            const Float distance = std::pow(Float(10), 12 * rng.Uniform());
            const std::optional<CameraConnection> seen = camera->Connect(ray(distance), lens, 0);
            ASSERT_TRUE(seen) << name;
            const Float weight = camera->RayWeight(ray.d, 0);
            const Float atPoint = camera->IsParallel() ? weight : weight / (distance * distance);
            EXPECT_NEAR(seen->weight / atPoint, 1, 1e-3) << name << " at " << distance;
        }
        if (camera->IsParallel()) continue;
        const bool seesAll = name.starts_with("equ");
        EXPECT_EQ(camera->RayWeight(-RayAt(*camera, {20, 10}, {0.5f, 0.5f}).ray.d, 0) > 0, seesAll) << name;
    }
}

/// The importance of all directions together is that of all pixels.
TEST(CameraConnection, ASphericalCameraConnectsToAllDirections) {
    for (const char *mapping : {"equalarea", "equirectangular"}) {
        const auto camera = MakeTestCamera("spherical", Params().String("mapping", mapping), {40, 20});
        Rng rng(4);
        RunningStatistics pixels;
        for (int i = 0; i < 80000; ++i) {
            const std::optional<CameraConnection> seen =
                camera->Connect(Float(2) * SampleUniformSphere(rng.Uniform2()), {}, 0);
            ASSERT_TRUE(seen);
            EXPECT_TRUE(seen->pFilm.x >= 0 && seen->pFilm.y >= 0 && seen->pFilm.x <= 40 && seen->pFilm.y <= 20);
            pixels.Add(double(seen->weight) * 4 * 4 * M_PI);
        }
        EXPECT_LT(std::abs(pixels.mean - 800), 4 * pixels.StandardError() + 0.01) << mapping;
        EXPECT_LT(pixels.StandardError(), 4) << mapping;
    }
}

TEST(CameraConnection, SphericalImagesContinueBeyondTheirEdges) {
    for (const char *mapping : {"equalarea", "equirectangular"}) {
        const auto camera = MakeTestCamera("spherical", Params().String("mapping", mapping), {40, 40});
        Rng rng(5);
        for (int i = 0; i < 300; ++i) {
            const Point2 film = Float(64) * rng.Uniform2() - Float(12);
            const Ray ray = RayAt(*camera, film).ray;
            const std::optional<CameraConnection> seen = camera->Connect(ray(3), {}, 0);
            ASSERT_TRUE(seen);
            Camera::OtherPlaces places;
            const int n = camera->WrappedPositions(seen->pFilm, places);
            Float nearest = glm::length(film - seen->pFilm);
            for (const Point2 &place : std::span(places).first(size_t(n))) {
                nearest = std::min(nearest, glm::length(film - place));
                ExpectClose(RayAt(*camera, place).ray.d, ray.d, 1e-3f, mapping);
                EXPECT_GT(glm::length(place - seen->pFilm), 0) << mapping;
            }
            EXPECT_LT(nearest, 0.01f) << mapping << " " << film.x << " " << film.y;
        }
    }
    Camera::OtherPlaces places;
    EXPECT_EQ(MakeTestCamera("perspective")->WrappedPositions({3, 4}, places), 0);
}

}  // namespace
}  // namespace pbrt::test
