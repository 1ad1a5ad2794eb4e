/* Calls of the system that fail, put in front of the C library's by LD_PRELOAD: what a full disk, a
 * broken one or too little memory do to a program.
 *
 *   FAIL_CALLS  write, fsync, rename, open (of a file that is to be written), truncate or memory
 *   FAIL_AT     the number of the first call that fails, from 1; 0: none
 *   FAIL_COUNT  calls that fail from there on; without it all
 *   FAIL_TOLD   a file that gets the number of calls, at the end
 *
 * Standard streams are let through. Memory is counted from main() on, in the first process only. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

enum kind { write_calls, fsync_calls, rename_calls, open_calls, truncate_calls, memory_calls, none };
static const char* const names[] = {"write", "fsync", "rename", "open", "truncate", "memory"};

static enum kind chosen = none;
static long first_to_fail, how_many;
static atomic_long calls;
static atomic_int started;
static pid_t process;

static int fails(enum kind kind) {
  if (!atomic_load(&started) || kind != chosen || getpid() != process) return 0;
  const long number = atomic_fetch_add(&calls, 1) + 1;
  return first_to_fail > 0 && number >= first_to_fail && number - first_to_fail < how_many;
}

static long number_in(const char* name, long otherwise) {
  const char* text = getenv(name);
  return text == NULL ? otherwise : atol(text);
}

__attribute__((constructor)) static void begin(void) {
  const char* word = getenv("FAIL_CALLS");
  for (int k = 0; word != NULL && k < none; ++k)
    if (strcmp(word, names[k]) == 0) chosen = (enum kind)k;
  first_to_fail = number_in("FAIL_AT", 0);
  how_many = number_in("FAIL_COUNT", 1L << 60);
  process = getpid();
}

__attribute__((destructor)) static void tell(void) {
  const char* path = getenv("FAIL_TOLD");
  if (path == NULL || getpid() != process) return;
  atomic_store(&started, 0);
  FILE* file = fopen(path, "w");
  if (file == NULL) return;
  fprintf(file, "%ld\n", atomic_load(&calls));
  fclose(file);
}

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

typedef int (*main_function)(int, char**, char**);
static main_function real_main;
static int counted_main(int argc, char** argv, char** environment) {
  atomic_store(&started, 1);
  return real_main(argc, argv, environment);
}
int __libc_start_main(main_function program, int argc, char** argv, void (*init)(void),
                      void (*fini)(void), void (*loader)(void), void* stack_end) {
  typedef int (*start)(main_function, int, char**, void (*)(void), void (*)(void), void (*)(void),
                       void*);
  real_main = program;
  return ((start)dlsym(RTLD_NEXT, "__libc_start_main"))(counted_main, argc, argv, init, fini,
                                                        loader, stack_end);
}

#define FAIL_WITH(kind, cause) \
  if (fails(kind)) {           \
    errno = cause;             \
    return -1;                 \
  }

ssize_t write(int file, const void* data, size_t bytes) {
  if (file > 2) FAIL_WITH(write_calls, ENOSPC)
  return NEXT(write)(file, data, bytes);
}
ssize_t pwrite(int file, const void* data, size_t bytes, off_t at) {
  FAIL_WITH(write_calls, ENOSPC)
  return NEXT(pwrite)(file, data, bytes, at);
}
ssize_t pwrite64(int file, const void* data, size_t bytes, off64_t at) {
  FAIL_WITH(write_calls, ENOSPC)
  return NEXT(pwrite64)(file, data, bytes, at);
}
int fsync(int file) {
  FAIL_WITH(fsync_calls, EIO)
  return NEXT(fsync)(file);
}
int fdatasync(int file) {
  FAIL_WITH(fsync_calls, EIO)
  return NEXT(fdatasync)(file);
}
int rename(const char* from, const char* to) {
  FAIL_WITH(rename_calls, EIO)
  return NEXT(rename)(from, to);
}
int renameat2(int a, const char* from, int b, const char* to, unsigned flags) {
  FAIL_WITH(rename_calls, EIO)
  return NEXT(renameat2)(a, from, b, to, flags);
}
int ftruncate(int file, off_t size) {
  FAIL_WITH(truncate_calls, EIO)
  return NEXT(ftruncate)(file, size);
}
int ftruncate64(int file, off64_t size) {
  FAIL_WITH(truncate_calls, EIO)
  return NEXT(ftruncate64)(file, size);
}

#define OPEN(name)                                                            \
  int name(const char* path, int flags, ...) {                                \
    va_list more;                                                             \
    va_start(more, flags);                                                    \
    const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(more, mode_t) : 0;    \
    va_end(more);                                                             \
    if ((flags & O_ACCMODE) != O_RDONLY) FAIL_WITH(open_calls, EIO)           \
    return NEXT(name)(path, flags, mode);                                     \
  }
OPEN(open)
OPEN(open64)

void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);

#define NO_MEMORY            \
  if (fails(memory_calls)) { \
    errno = ENOMEM;          \
    return NULL;             \
  }

void* malloc(size_t bytes) {
  NO_MEMORY
  return __libc_malloc(bytes);
}
void* calloc(size_t count, size_t bytes) {
  NO_MEMORY
  return __libc_calloc(count, bytes);
}
void* realloc(void* old, size_t bytes) {
  NO_MEMORY
  return __libc_realloc(old, bytes);
}
void* aligned_alloc(size_t alignment, size_t bytes) {
  NO_MEMORY
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** place, size_t alignment, size_t bytes) {
  if (fails(memory_calls)) return ENOMEM;
  *place = __libc_memalign(alignment, bytes);
  return *place == NULL ? ENOMEM : 0;
}
