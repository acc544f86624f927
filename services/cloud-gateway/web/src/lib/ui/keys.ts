/** Keys for a list of others' data: each once, also if several rows wish for the same. */
export function uniqueKeys(wished: readonly string[]): string[] {
  const taken = new Set<string>();
  return wished.map((wish) => {
    let key = wish;
    for (let count = 1; taken.has(key); ++count) key = `${wish}\n${count}`;
    taken.add(key);
    return key;
  });
}
