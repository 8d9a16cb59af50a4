#include "features/volumetrics/reference/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <embree3/rtcore.h>
#include <glm/geometric.hpp>

#include "features/volumetrics/reference/shadow.hpp"

namespace tyndall::volumetrics::reference {
namespace {

glm::dvec3 area_vector(const Triangle& triangle) {
    const auto& [a, b, c] = triangle.corners;
    return glm::cross(b - a, c - a);
}

template <class EmbreeRay>
EmbreeRay embree_ray(const Ray& ray, double distance_m) {
    EmbreeRay r{};
    r.org_x = static_cast<float>(ray.origin.x);
    r.org_y = static_cast<float>(ray.origin.y);
    r.org_z = static_cast<float>(ray.origin.z);
    r.dir_x = static_cast<float>(ray.direction.x);
    r.dir_y = static_cast<float>(ray.direction.y);
    r.dir_z = static_cast<float>(ray.direction.z);
    r.tfar = static_cast<float>(distance_m);
    r.mask = ~0U;
    return r;
}

/// No plane holds both: the light lies on the ray's line as exactly as doubles tell.
bool is_parallel(const glm::dvec3& direction, const glm::dvec3& toward) {
    return glm::length(glm::cross(direction, toward)) < 1e-12;
}

std::vector<Interval> all_or_nothing(bool lit, Interval part) {
    return lit ? std::vector{part} : std::vector<Interval>{};
}

} // namespace

struct Geometry::State {
    explicit State(std::vector<Triangle> given) : triangles(std::move(given)), tree(triangles) {
        device = rtcNewDevice("threads=1");
        scene = rtcNewScene(device);
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
        if (!triangles.empty()) {
            RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
            auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
                mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * triangles.size()));
            auto* index = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
                mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), triangles.size()));
            std::uint32_t count = 0;
            for (const Triangle& triangle : triangles) {
                for (const glm::dvec3& corner : triangle.corners) {
                    *vertex++ = static_cast<float>(corner.x);
                    *vertex++ = static_cast<float>(corner.y);
                    *vertex++ = static_cast<float>(corner.z);
                    *index++ = count++;
                }
            }
            rtcCommitGeometry(mesh);
            rtcAttachGeometry(scene, mesh);
            rtcReleaseGeometry(mesh);
        }
        rtcCommitScene(scene);
    }
    ~State() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    std::vector<Triangle> triangles;
    ShadowTree tree;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
};

Geometry::Geometry() : Geometry(std::vector<Triangle>{}) {}

Geometry::Geometry(std::vector<Triangle> triangles) {
    std::erase_if(triangles, [](const Triangle& triangle) { return !(glm::length(area_vector(triangle)) > 0.0); });
    state_ = std::make_unique<State>(std::move(triangles));
}

Geometry::~Geometry() = default;
Geometry::Geometry(Geometry&&) noexcept = default;
Geometry& Geometry::operator=(Geometry&&) noexcept = default;

const std::vector<Triangle>& Geometry::triangles() const {
    return state_->triangles;
}

std::optional<Hit> Geometry::hit(const Ray& ray) const {
    RTCRayHit query{};
    query.ray = embree_ray<RTCRay>(ray, std::numeric_limits<double>::infinity());
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(state_->scene, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        return std::nullopt;
    }
    const Triangle& triangle = state_->triangles[query.hit.primID];
    Hit hit;
    hit.triangle = query.hit.primID;
    hit.normal = glm::normalize(area_vector(triangle));
    const double approach = glm::dot(hit.normal, ray.direction);
    hit.distance_m = glm::dot(triangle.corners[0] - ray.origin, hit.normal) / approach;
    const auto found_m = static_cast<double>(query.ray.tfar);
    if (!(std::abs(hit.distance_m - found_m) < 1e-3 * found_m)) { // edge-on
        hit.distance_m = found_m;
    }
    if (approach > 0.0) {
        hit.normal = -hit.normal;
    }
    return hit;
}

bool Geometry::is_blocked(const Ray& ray, double distance_m) const {
    RTCRay query = embree_ray<RTCRay>(ray, distance_m);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(state_->scene, &context, &query);
    return query.tfar < 0.0F;
}

std::vector<Interval> Geometry::lit_from_direction(const Ray& ray, Interval part, const glm::dvec3& toward) const {
    if (!is_parallel(ray.direction, toward)) {
        return state_->tree.lit_from_direction(ray, part, toward);
    }
    // Nothing stands on the part itself: what is seen of one of its points toward the light is seen of all.
    const Ray back{point_at(ray, part.begin), toward};
    return all_or_nothing(!is_blocked(back, std::numeric_limits<double>::infinity()), part);
}

std::vector<Interval> Geometry::lit_from_point(const Ray& ray, Interval part, const glm::dvec3& light) const {
    const glm::dvec3 way = light - ray.origin;
    const double distance_m = glm::length(way);
    if (!(distance_m > 0.0)) {
        return {part};
    }
    if (!is_parallel(ray.direction, way / distance_m)) {
        return state_->tree.lit_from_point(ray, part, light);
    }
    const double foot = glm::dot(way, ray.direction);
    if (foot >= part.begin && foot <= part.end) {
        return {part};
    }
    const glm::dvec3 near = point_at(ray, foot < part.begin ? part.begin : part.end);
    const double rest_m = glm::length(light - near);
    return all_or_nothing(!is_blocked({near, (light - near) / rest_m}, rest_m * (1.0 - 1e-6)), part);
}

} // namespace tyndall::volumetrics::reference
