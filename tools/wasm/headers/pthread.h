// Stand-in for the storage of threads (sim/base/threads.h): the engine has one, which does not end.
#pragma once

using pthread_key_t = unsigned;
inline int pthread_key_create(pthread_key_t*, void (*)(void*)) { return 0; }
inline int pthread_setspecific(pthread_key_t, const void*) { return 0; }
