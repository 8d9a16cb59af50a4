// One frame of a plan, replayed command by command. Internal to the checker.
#pragma once

#include <span>

#include "rendergraph/verify_state.hpp"

namespace tyndall::rg::checker {

class Replay {
public:
    Replay(const GraphDesc& graph, const Plan& plan, Order& order, Memory& memory, std::vector<Violation>& found);
    void run();

private:
    /// Something that is about to touch memory: a pass, or a barrier's transition (which has a source scope).
    struct Toucher {
        std::uint32_t pass = none;
        std::uint32_t queue = 0;
        std::uint32_t sequence = 0;
        StageSet stages = 0;
        VkAccessFlags2 access = 0;
        bool writes = false;
        const SourceScope* source = nullptr;
        const Effect* effect = nullptr;
    };

    void report(ViolationCode code, std::uint32_t pass, std::uint32_t other, std::uint32_t resource,
                std::string message);
    [[nodiscard]] std::string pass_name(std::uint32_t pass) const;
    [[nodiscard]] std::string resource_name(std::uint32_t resource) const;

    // Submissions and commands.
    void begin_batch(std::uint32_t index);
    void end_batch(std::uint32_t index);
    void pass(const PlannedPass& planned, std::uint32_t queue);
    void barriers(std::uint32_t queue, std::uint32_t before_pass);
    [[nodiscard]] SourceScope& new_scope(StageSet stages);
    [[nodiscard]] const SourceScope* scope_of(const Effect& effect) const;
    void act(const Effect& effect, const SourceScope& source, std::uint32_t queue, std::uint32_t before_pass);
    void change_owner(const Effect& effect, Atom& atom, std::uint32_t before_pass);
    void carry_memory(const Effect& effect, const SourceScope& source, const Point& here);
    void carry(Event& event, const Effect& effect, const SourceScope& source, const Point& here, bool same_resource);
    void record_act(const Effect& effect, const Point& here);

    // Accesses.
    void check_access(const AccessDesc& access, const Toucher& toucher, const AttachmentOps* ops);
    void check_state(const AccessDesc& access, const Toucher& toucher, const Atom& atom, const AttachmentOps* ops);
    void record_access(const AccessDesc& access, const Toucher& toucher, const AttachmentOps* ops);
    [[nodiscard]] const AttachmentOps* operations_of(const PlannedPass& planned, std::uint32_t access) const;
    /// The version whose content a reader of `version` must find in the atom.
    [[nodiscard]] std::uint32_t expected_version(const Object& object, const Atom& atom, std::uint32_t version) const;

    // Conflicts.
    void check_conflicts(Object& object, const Atom& atom, const Toucher& toucher);
    void check_against(const Event& event, std::uint32_t frame, const Toucher& toucher, std::uint32_t resource,
                       bool same_content);
    [[nodiscard]] bool ordered(const Event& event, const Toucher& toucher) const;
    [[nodiscard]] bool available(const Event& event, const Toucher& toucher, bool same_content) const;
    [[nodiscard]] bool available_in(const Event& event, const SourceScope& source) const;
    [[nodiscard]] bool visible(const Event& event, const Toucher& toucher) const;

    // The frame's end.
    void check_end(std::uint32_t resource);
    void check_import_end(Object& object, const ImportDesc& import);
    [[nodiscard]] bool before_host(const Event& event, const ImportDesc& import) const;
    [[nodiscard]] bool visible_to_host(const Event& event, const ImportDesc& import) const;

    const GraphDesc& graph_;
    const Plan& plan_;
    Order& order_;
    Memory& memory_;
    std::vector<Violation>& found_;
    std::uint32_t frame_ = 0;
    std::vector<Clock> signals_;                          ///< by batch
    std::vector<std::vector<std::uint32_t>> exits_after_; ///< by batch: dependencies recorded at its end
    // Of the barrier command at hand; kept for their memory.
    std::vector<Effect> effects_;
    std::vector<std::pair<StageSet, SourceScope>> scopes_;
    std::size_t scope_count_ = 0;
};

} // namespace tyndall::rg::checker
