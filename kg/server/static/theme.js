// Sets the theme before anything is drawn: "light" or "dark" as chosen, else that of the system.
(() => {
  try {
    const chosen = localStorage.getItem("kg-theme");
    if (chosen === "light" || chosen === "dark") document.documentElement.dataset.theme = chosen;
  } catch {
    // Storage may be forbidden; the theme of the system holds then.
  }
})();
