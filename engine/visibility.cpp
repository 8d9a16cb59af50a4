#include "engine/visibility.hpp"

#include <algorithm>
#include <utility>

namespace tyndall::engine {
namespace {

const Material& material_of(const Scene& scene, const Instance& instance) {
    return scene.materials[scene.primitives[instance.primitive].material];
}

/// Light passes through what is blended: it throws no shadow.
bool casts_shadow(const Scene& scene, const Instance& instance) {
    return material_of(scene, instance).alpha_mode != AlphaMode::blend && !instance.box.empty();
}

} // namespace

DrawLists visible_instances(const Scene& scene, const FrameView& view) {
    using Keyed = std::pair<double, std::uint32_t>;
    const Frustum frustum = make_frustum(view);
    std::vector<Keyed> surfaces;
    std::vector<Keyed> transparents;
    DrawLists lists;
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (instance.box.empty() || !may_be_visible(frustum, instance.box, view.origin_m)) {
            continue;
        }
        const double depth_m = view_depth_m(view, instance.box.center());
        const double middle_m = view_depth_m(view, instance.sphere.center);
        const double radius_m = instance.sphere.radius_m;
        const DepthSpan own{std::max(middle_m - radius_m, 0.0), std::max(middle_m + radius_m, 0.0)};
        lists.depth_m = lists.depth_m ? DepthSpan{std::min(lists.depth_m->nearest_m, own.nearest_m),
                                                  std::max(lists.depth_m->farthest_m, own.farthest_m)}
                                      : own;
        if (material_of(scene, instance).alpha_mode == AlphaMode::blend) {
            transparents.emplace_back(-depth_m, i);
        } else {
            surfaces.emplace_back(depth_m - instance.sphere.radius_m, i);
        }
    }
    std::sort(surfaces.begin(), surfaces.end());
    std::sort(transparents.begin(), transparents.end());
    for (const Keyed& surface : surfaces) {
        lists.surfaces.push_back(surface.second);
    }
    for (const auto& [minus_depth_m, instance] : transparents) {
        lists.transparents.push_back(instance);
        lists.transparent_depths_m.push_back(static_cast<float>(-minus_depth_m));
    }
    return lists;
}

Casters shadow_casters(const Scene& scene) {
    Casters casters;
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (casts_shadow(scene, instance)) {
            casters.instances.push_back(i);
            casters.boxes.push_back(instance.box);
            casters.bounds.grow(instance.box);
        }
    }
    return casters;
}

} // namespace tyndall::engine
