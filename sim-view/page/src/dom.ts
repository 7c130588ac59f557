// Creates native elements.

/** An element with properties and children; `testid` and `label` become `data-testid` and `aria-label`. */
export function element<K extends keyof HTMLElementTagNameMap>(
  name: K,
  properties: Partial<HTMLElementTagNameMap[K]> & { testid?: string; label?: string } = {},
  children: readonly (Node | string)[] = [],
): HTMLElementTagNameMap[K] {
  const { testid, label, ...rest } = properties;
  const made = document.createElement(name);
  Object.assign(made, rest);
  if (testid !== undefined) made.dataset["testid"] = testid;
  if (label !== undefined) made.setAttribute("aria-label", label);
  made.append(...children);
  return made;
}
