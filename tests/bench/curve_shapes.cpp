// Do Embree's curves have the shape of pbrt's? Sends rays past single flat Bezier segments, tests Embree's flat curve
// (same linear width, finest tessellation) and our Curves, which match stock's pictures, and prints how often and by
// how much they differ.
#include <embree3/rtcore.h>

#include <cmath>
#include <cstdio>
#include <optional>

#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "pbrt/shapes/curves.h"

namespace pbrt {
namespace {

std::optional<PrimitiveHit> OurHit(const Curves &c, const Point3 &o, const Vector3 &d) {
    std::optional<PrimitiveHit> best;
    for (uint32_t i = 0; i < c.PrimitiveCount(); ++i)
        if (auto hit = c.Intersect(i, {o, d, best ? best->t : Infinity}, 0)) best = hit;
    return best;
}

class EmbreeCurve {
  public:
    EmbreeCurve(RTCDevice device, const Curves::Segment &s) : scene_(rtcNewScene(device)) {
        RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_FLAT_BEZIER_CURVE);
        rtcSetGeometryTessellationRate(g, 16);
        auto *v = static_cast<float *>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, 4));
        for (int k = 0; k < 4; ++k) {
            for (int a = 0; a < 3; ++a) v[4 * k + a] = s.curve.p[k][a];
            v[4 * k + 3] = Lerp(Float(k) / 3, s.width0, s.width1) / 2;
        }
        *static_cast<unsigned *>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, 4, 1)) = 0;
        rtcCommitGeometry(g);
        rtcAttachGeometry(scene_, g);
        rtcReleaseGeometry(g);
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcCommitScene(scene_);
    }
    ~EmbreeCurve() { rtcReleaseScene(scene_); }
    EmbreeCurve(const EmbreeCurve &) = delete;
    EmbreeCurve &operator=(const EmbreeCurve &) = delete;

    std::optional<PrimitiveHit> Hit(const Point3 &o, const Vector3 &d) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit r{};
        r.ray.org_x = o.x, r.ray.org_y = o.y, r.ray.org_z = o.z;
        r.ray.dir_x = d.x, r.ray.dir_y = d.y, r.ray.dir_z = d.z;
        r.ray.tfar = Infinity;
        r.ray.mask = ~0u;
        r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &r);
        if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
        return PrimitiveHit{r.ray.tfar, r.hit.u, r.hit.v};
    }

  private:
    RTCScene scene_;
};

struct Looks {
    const char *name;
    Float bend, width;
    Float distance;  ///< of the rays' origins; 0: two widths
};

void Compare(RTCDevice device, const Looks &looks) {
    Rng rng(1);
    auto direction = [&] { return SampleUniformSphere(rng.Uniform2()); };
    int rays = 0, ours = 0, theirs = 0, one = 0, both = 0, farInU = 0, farInV = 0;
    double depth = 0;
    for (int k = 0; k < 500; ++k) {
        Curves::Segment s;
        Point3 at(0);
        const Vector3 step = direction() / Float(3);
        for (Point3 &p : s.curve.p) {
            p = at;
            at += step + looks.bend / 3 * direction();
        }
        s.width0 = looks.width * (Float(0.5) + rng.Uniform());
        s.width1 = looks.width * (Float(0.5) + rng.Uniform());
        const Curves curves(CurveKind::Flat, {s}, {}, Transform(), false);
        const EmbreeCurve embree(device, s);
        for (int i = 0; i < 400; ++i) {
            const Point3 target = s.curve.At(rng.Uniform()) + looks.width * direction();
            // Near ones start two widths away, as rays between hairs do.
            const Point3 o = looks.distance > 0 ? looks.distance * direction() : target + 2 * looks.width * direction();
            const Vector3 d = target - o;
            const auto a = OurHit(curves, o, d), b = embree.Hit(o, d);
            ++rays;
            ours += a.has_value();
            theirs += b.has_value();
            one += a.has_value() != b.has_value();
            if (!a || !b) continue;
            ++both;
            farInU += std::abs(a->u - b->u) > Float(0.01);
            const Float v = (b->v + 1) / 2;
            farInV += std::min(std::abs(a->v - v), std::abs(a->v - (1 - v))) > Float(0.05);
            depth += double(std::abs(a->t - b->t) * Length(d) / looks.width);
        }
    }
    auto percent = [](int n, int of) { return 100.0 * n / std::max(of, 1); };
    std::printf("%-20s %8d %8.2f%% %8.2f%% %9.2f%% %9.2f%% %9.2f%% %9.3f\n", looks.name, rays, percent(ours, rays),
                percent(theirs, rays), percent(one, ours), percent(farInU, both), percent(farInV, both),
                depth / std::max(both, 1));
}

}  // namespace
}  // namespace pbrt

int main() {
    RTCDevice device = rtcNewDevice(nullptr);
    std::printf("%-20s %8s %9s %9s %10s %10s %10s %9s\n", "curve (length 1)", "rays", "ours", "Embree", "one only",
                "u > 0.01", "v > 0.05", "depth/w");
    const pbrt::Looks all[] = {{"straight, thin", 0.1f, 0.01f, 3},   {"straight, thin, near", 0.1f, 0.01f, 0},
                               {"bent, thin", 0.8f, 0.01f, 3},       {"bent, wide", 0.8f, 0.1f, 3},
                               {"bent, thin, near", 0.8f, 0.01f, 0}, {"bent, wide, near", 0.8f, 0.1f, 0}};
    for (const pbrt::Looks &looks : all) pbrt::Compare(device, looks);
    rtcReleaseDevice(device);
}
