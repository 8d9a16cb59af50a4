/* Preloaded under the sanitisers: drivers and layers stay loaded to the end, so that the stacks of reports name them and
   the suppressions beside this file can match. */
int dlclose(void* handle);
int dlclose(void* handle) {
    (void)handle;
    return 0;
}
