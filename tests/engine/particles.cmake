# Particle file, simulation, sort and billboards: all but the first on a device.
tyndall_test(tyndall_particles_tests gpu
    particle_model.cpp
    particles_draw_test.cpp
    particles_fixture.cpp
    particles_json_test.cpp
    particles_test.cpp)
target_link_libraries(tyndall_particles_tests PRIVATE tyndall::engine tyndall_gpu_fixture)

# The same in the other ways in which a frame can run: see tests/gpu/gpu_fixture.hpp.
foreach(mode single_command_buffer folded semaphores)
    add_test(NAME particles.${mode} COMMAND tyndall_particles_tests)
    set_tests_properties(particles.${mode} PROPERTIES LABELS gpu ENVIRONMENT TYNDALL_TEST_MODE=${mode})
endforeach()
