#pragma once
#include "pbrt/lights/light_bounds.h"
#include "pbrt/math/simd_ops.h"

namespace pbrt {

/// N lights as structure of arrays, with joint importance evaluation. Unset lanes have importance 0.
template <int N>
struct alignas(4 * N) LightPacket {
    Float centerX[N] = {}, centerY[N] = {}, centerZ[N] = {}, radius[N] = {};
    Float axisX[N] = {}, axisY[N] = {}, axisZ[N] = {}, phi[N] = {};
    Float cosO[N] = {}, sinO[N] = {}, cosE[N] = {};
    Float twoSided[N] = {};  ///< 0 or 1

    void Set(int lane, const LightSphere &s) {
        centerX[lane] = s.center.x;
        centerY[lane] = s.center.y;
        centerZ[lane] = s.center.z;
        radius[lane] = s.radius;
        axisX[lane] = s.w.x;
        axisY[lane] = s.w.y;
        axisZ[lane] = s.w.z;
        phi[lane] = s.phi;
        cosO[lane] = s.cosTheta_o;
        sinO[lane] = detail::SineOf<detail::ScalarOps>(s.cosTheta_o);
        cosE[lane] = s.cosTheta_e;
        twoSided[lane] = s.twoSided ? 1 : 0;
    }

    void Importances(const Point3 &p, const Normal3 &n, Float *out) const {
        using Ops = SimdOps<N>;
        using F = typename Ops::F;
        auto load = [](const Float *v) { return Ops::Load(v); };
        detail::Emitters<F, typename Ops::Mask> e{
            load(centerX), load(centerY), load(centerZ), load(radius), load(axisX), load(axisY),           load(axisZ),
            F(1),          load(phi),     load(cosO),    load(sinO),   load(cosE),  load(twoSided) != F(0)};
        Ops::Store(detail::ImportanceOf<Ops>(e, p, n), out);
    }
};

}  // namespace pbrt
