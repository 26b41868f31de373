/* SPDX-License-Identifier: GPL-3.0-or-later
 * The file `shearcell` of the archive. It runs lib/program with the loader and the C library in
 * lib, so the machine's own C library does not matter. Starting the loader by execve() would do
 * that too, but then /proc/self/exe, which `submit` writes into its jobs, and the name in `top`
 * would be the loader's. So this program maps the loader into its own process, as the kernel would,
 * and jumps to it. It has no C library: x86-64 Linux only.
 */
#include <elf.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/syscall.h>

#define PAGE 4096ul
#define DOWN(address) ((address) & ~(PAGE - 1))
#define UP(address) DOWN((address) + PAGE - 1)

static char loader[4200] = "", library[4200], program[4200];
static char image[PAGE] __attribute__((aligned(16))); /* the loader's headers */

static long call(long number, long a, long b, long c, long d, long e, long f) {
  register long r10 __asm__("r10") = d, r8 __asm__("r8") = e, r9 __asm__("r9") = f;
  __asm__ volatile("syscall"
                   : "+a"(number)
                   : "D"(a), "S"(b), "d"(c), "r"(r10), "r"(r8), "r"(r9)
                   : "rcx", "r11", "memory");
  return number;
}

static long length(const char* text) {
  long n = 0;
  while (text[n] != '\0') ++n;
  return n;
}

static void say(const char* text) {
  call(SYS_write, 2, (long)text, length(text), 0, 0, 0);
}

static __attribute__((noreturn)) void give_up(const char* why) {
  say("shearcell: ");
  say(loader);
  say(why);
  call(SYS_exit_group, 1, 0, 0, 0, 0, 0);
  __builtin_unreachable();
}

/* Writes FOLDER, which ends with a slash, and `name`. */
static void join(char* out, const char* folder, long n, const char* name) {
  for (long i = 0; i < n; ++i) out[i] = folder[i];
  for (long i = 0; i <= length(name); ++i) out[n + i] = name[i];
}

static long map(unsigned long at, unsigned long bytes, int protection, int flags, long file,
                unsigned long offset) {
  const long mapped =
      call(SYS_mmap, (long)at, (long)bytes, protection, MAP_PRIVATE | flags, file, (long)offset);
  if (mapped < 0 && mapped > -(long)PAGE) give_up(" cannot be mapped: too little memory\n");
  return mapped;
}

/* Maps the loader as the kernel would, and returns its address. */
static unsigned long map_loader(void) {
  const long file = call(SYS_open, (long)loader, O_RDONLY | O_CLOEXEC, 0, 0, 0, 0);
  if (file < 0)
    give_up(" cannot be opened: `shearcell` needs the folder `lib` of its archive beside it\n");
  const Elf64_Ehdr* head = (const Elf64_Ehdr*)image;
  const Elf64_Phdr* parts = (const Elf64_Phdr*)(image + sizeof *head);
  if (call(SYS_read, file, (long)image, PAGE, 0, 0, 0) < (long)sizeof *head ||
      head->e_phoff != sizeof *head || sizeof *head + head->e_phnum * sizeof *parts > PAGE) {
    give_up(" is not the loader of the archive: unpack the archive again\n");
  }
  unsigned long end = 0;
  for (int i = 0; i < head->e_phnum; ++i) {
    if (parts[i].p_type == PT_LOAD) end = UP(parts[i].p_vaddr + parts[i].p_memsz);
  }
  const unsigned long base = (unsigned long)map(0, end, PROT_NONE, MAP_ANONYMOUS, -1, 0);
  for (int i = 0; i < head->e_phnum; ++i) {
    const Elf64_Phdr part = parts[i];
    if (part.p_type != PT_LOAD) continue;
    const int protection = (part.p_flags & PF_R ? PROT_READ : 0) |
                           (part.p_flags & PF_W ? PROT_WRITE : 0) |
                           (part.p_flags & PF_X ? PROT_EXEC : 0);
    const unsigned long begin = base + DOWN(part.p_vaddr),
                        data = base + part.p_vaddr + part.p_filesz,
                        last = UP(base + part.p_vaddr + part.p_memsz);
    map(begin, data - begin, protection, MAP_FIXED, file, DOWN(part.p_offset));
    if (part.p_memsz == part.p_filesz) continue;
    for (char* zero = (char*)data; zero < (char*)UP(data); ++zero) *zero = 0;
    if (last > UP(data))
      map(UP(data), last - UP(data), protection, MAP_FIXED | MAP_ANONYMOUS, -1, 0);
  }
  call(SYS_close, file, 0, 0, 0, 0, 0);
  return base;
}

static int begins(const char* text, const char* with) {
  while (*with != '\0' && *text == *with) ++text, ++with;
  return *with == '\0';
}

/* `stack` is what the kernel passes: argc, the arguments, 0, the environment, 0, the auxiliary
 * vector. */
__attribute__((used, noreturn)) static void launch(const long* stack) {
  static char own[4097];
  const long count = stack[0];
  const long *arguments = stack + 1, *variables = arguments + count + 1, *auxiliary = variables;
  while (*auxiliary++ != 0) {
  }
  const long* end = auxiliary;
  const char* name = "";
  for (; end[0] != AT_NULL; end += 2) {
    if (end[0] == AT_EXECFN) name = (const char*)end[1];
  }
  /* Without /proc, the path by which the program was started. */
  const long read = call(SYS_readlink, (long)"/proc/self/exe", (long)own, sizeof own - 1, 0, 0, 0);
  if (read <= 0) join(own, name, length(name) < 4096 ? length(name) : 0, "");
  long folder = length(own);
  while (folder > 0 && own[folder - 1] != '/') --folder;
  join(loader, own, folder, "lib/ld-linux-x86-64.so.2");
  join(library, own, folder, "lib");
  join(program, own, folder, "lib/program");
  for (const char* c = library; *c != '\0'; ++c) {
    if (*c == ':' || *c == ';')
      give_up(": the path of the archive must not contain ':' or ';': move the archive\n");
  }
  const unsigned long base = map_loader();
  const Elf64_Ehdr* head = (const Elf64_Ehdr*)image;

  /* As if the user had typed: lib/ld-linux-x86-64.so.2 --library-path lib ... lib/program ARGUMENTS
   */
  const long first[] = {(long)loader,           (long)"--inhibit-cache",
                        (long)"--library-path", (long)library,
                        (long)"--argv0",        arguments[0] ? arguments[0] : (long)"shearcell",
                        (long)program};
  const long added = sizeof first / sizeof *first;
  long words[(end - stack) + added + 4];
  long* to = (long*)(((unsigned long)words + 15) & ~15ul);
  long* const begin = to;
  *to++ = added + (count > 0 ? count - 1 : 0);
  for (long i = 0; i < added; ++i) *to++ = first[i];
  for (long i = 1; i < count; ++i) *to++ = arguments[i];
  *to++ = 0;
  for (; *variables != 0; ++variables) {
    /* Libraries that a machine loads into every program need the machine's own C library. */
    const char* text = (const char*)*variables;
    if (!begins(text, "LD_PRELOAD=") && !begins(text, "LD_AUDIT=")) *to++ = *variables;
  }
  *to++ = 0;
  for (; auxiliary < end; auxiliary += 2) {
    *to++ = auxiliary[0];
    *to++ = auxiliary[0] == AT_PHDR    ? (long)(base + head->e_phoff)
            : auxiliary[0] == AT_PHNUM ? head->e_phnum
            : auxiliary[0] == AT_ENTRY ? (long)(base + head->e_entry)
            : auxiliary[0] == AT_BASE  ? 0
                                       : auxiliary[1];
  }
  *to++ = AT_NULL;
  *to = 0;
  __asm__ volatile("mov %0, %%rsp\n\txor %%edx, %%edx\n\txor %%ebp, %%ebp\n\tjmp *%1"
                   :
                   : "r"(begin), "r"(base + head->e_entry)
                   : "memory");
  __builtin_unreachable();
}

__asm__(
    ".globl _start\n_start:\n\txor %ebp, %ebp\n\tmov %rsp, %rdi\n\tand $-16, %rsp\n\tcall "
    "launch\n");
